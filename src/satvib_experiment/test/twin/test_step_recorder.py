# SPDX-FileCopyrightText: 2026 The satvib authors
# SPDX-License-Identifier: Apache-2.0
"""Each figure has one name: the twin records what the messages of the graph hold."""

from pathlib import Path

import numpy as np
import pytest
from satvib_experiment.recording.topics import TOPICS
from satvib_experiment.twin.closed_loop import simulate_batch

MESSAGES = Path(__file__).resolve().parents[3] / 'satvib_msgs' / 'msg'
# what a message has besides the figures of its strut
OF_ALL_STRUTS = {'header', 'sequence', 'sample_period', 'delay', 'phase', 'law', 'missed_samples'}
# what nodes tell each other, which the twin knows without telling
OF_THE_MACHINE = {
    'time_step', 'compute_time', 'applied', 'applied_state', 'pace',
}  # fmt: skip
# how a bag packs samples and models
PACKING = {
    'samples', 'strokes', 'stroke_peaks', 'force_peaks', 'currents', 'next_sequence', 'fine_period',
}  # fmt: skip


def fields_of(message):
    lines = (MESSAGES / f'{message}.msg').read_text().splitlines()
    return {line.split()[1] for line in lines if line.strip() and line[0] != '#'}


@pytest.mark.parametrize('group', TOPICS)
def test_the_twin_records_the_fields_of_the_message(quick_run, group):
    """Truth: the definition of the message."""
    of_the_machine = OF_THE_MACHINE | ({'bias_lower'} if group == 'model' else set())
    wanted = fields_of(TOPICS[group][1]) - OF_ALL_STRUTS - of_the_machine - PACKING
    assert set(quick_run.groups[group]) - {'present'} == wanted


def test_only_what_is_asked_for_is_kept(quick_run):
    """Truth: the run with everything, every bit of a group and of one field; nothing else is there."""
    kept = simulate_batch([quick_run.scenario], keep=('acceleration', 'truth.stroke'))[0]
    assert set(kept.groups) == {'acceleration', 'truth'}
    assert set(kept.groups['truth']) == {'stroke', 'present'}
    assert np.array_equal(kept.get('truth', 'stroke'), quick_run.get('truth', 'stroke'))
    for name, values in quick_run.groups['acceleration'].items():
        assert np.array_equal(kept.get('acceleration', name), values, equal_nan=True)
