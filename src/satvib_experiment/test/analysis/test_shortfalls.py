# SPDX-FileCopyrightText: 2026 The satvib authors
# SPDX-License-Identifier: Apache-2.0
"""Runs that did nothing say so. Truth: the scenario, which makes them useless on purpose."""

from dataclasses import replace

import numpy as np
import pytest
from satvib_common.struts.applied import TEXTS, Applied
from satvib_experiment.analysis.evaluation import evaluate
from satvib_experiment.analysis.shortfalls import shortfalls
from satvib_experiment.scenario.scenario import load_scenario
from satvib_experiment.twin.closed_loop import simulate


@pytest.fixture(scope='module')
def sound():
    return simulate(load_scenario('quick_3dof'))


def test_a_sound_run_has_none(sound):
    assert shortfalls(sound) == []


def test_no_trusted_model_and_no_voltage_are_said():
    """A voltage that excites nothing: no model is trusted, so the law gives 0 V."""
    changes = ['controller.law=narrowband', 'controller.excitation_amplitude=1e-6']
    found = shortfalls(simulate(load_scenario('quick_3dof', changes)))
    assert [line.split(':')[0] for line in found] == [
        'No strut has a model that is trusted',
        'The voltage was 0 V at every strut, from the first sample of CONTROL to the last',
    ]


def test_a_run_that_is_not_meant_to_act_has_none():
    assert shortfalls(simulate(load_scenario('quick_3dof', ['controller.law=off']))) == []


@pytest.mark.parametrize(
    ('state', 'share', 'said'),
    [
        (
            Applied.LATCHED,
            0.0,
            ['No coil got any voltage of CONTROL, though the laws asked for some'],
        ),
        (
            Applied.WAITING,
            0.0,
            ['No coil got any voltage of CONTROL, though the laws asked for some'],
        ),
        (Applied.APPLIED, 1.0, []),
        (Applied.UNKNOWN, 0.0, []),
    ],
)
def test_voltages_that_were_never_applied_are_said(sound, state, share, said):
    """Truth: by hand. The laws asked as in a sound run; what the coils got is what the source of the samples says."""
    asked = sound.get('voltage', 'voltage')
    got = share * np.roll(asked, 1, axis=0)
    samples = sound.groups['acceleration'] | {
        'applied': got,
        'applied_state': np.full(asked.shape, state, np.uint8),
    }
    run = replace(sound, groups=sound.groups | {'acceleration': samples})
    found = shortfalls(run)
    assert [line.split(':')[0] for line in found] == said
    assert all(TEXTS[state] in line for line in found)


@pytest.mark.parametrize(('late', 'said'), [(10, False), (20, True)])
def test_late_answers_are_counted_against_all(sound, late, said):
    """Truth: 1 % of samples times three struts."""
    count = late * len(sound.sequence) * 3 // 1000
    run = replace(sound, counts={'plant_sim_late_voltages': count})
    assert [
        f'{count} of {len(sound.sequence) * 3} voltages' in line for line in shortfalls(run)
    ] == [True] * said


def test_a_disturbance_that_ends_before_control_is_none(sound):
    """Truth: by hand. The open loop rests in the stretch under control; without control there was a vibration."""
    rest = {name: np.zeros_like(array) for name, array in sound.groups['truth'].items()}
    twin = replace(sound, groups=sound.groups | {'truth': rest})
    assert shortfalls(sound, evaluate(sound, twin))[0].startswith('There was no disturbance')
    found = evaluate(sound, sound)
    found.at_rest[:] = True
    (line,) = shortfalls(sound, found)
    assert line.startswith('There was no disturbance in the stretch under control, 3.4 to 4 s')


def test_control_that_was_not_recorded_is_said(sound):
    """Truth: by hand; CONTROL begins at 3 s."""
    short = replace(sound, sequence=sound.sequence[:100], groups={})
    assert shortfalls(short) == [
        'Nothing is under control: the recording has no sample of CONTROL, from 3 s.'
    ]
