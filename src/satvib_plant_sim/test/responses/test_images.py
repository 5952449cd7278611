# SPDX-FileCopyrightText: 2026 The satvib authors
# SPDX-License-Identifier: Apache-2.0
"""The images of a held voltage, and the voltage that serves the payload between the samples."""

import numpy as np
import pytest
from numpy.testing import assert_allclose
from satvib_plant_sim.responses.images import (
    IMAGES,
    hold_response,
    lines,
    payload_weight,
    weight_table,
)
from satvib_plant_sim.responses.one_strut import strut_response
from satvib_plant_sim.responses.periodic import best_command
from satvib_plant_sim.rig.rig import load_rig

RIGS = {
    'paper': ('paper_3dof', {}),
    'matched': (
        'clean_3dof', {'acquisition.sample_rate': 100.0, 'acquisition.hold': 'zero',
                       'acquisition.filter_order': 4, 'acquisition.filter_corner': 35.0}
    ),
    'late': ('paper_3dof', {'acquisition.input_delay': 6e-3}),
}  # fmt: skip


def left(rig, frequency, weight):
    """Level, dB, that struts with u = -W d / G_1, d = y - G_1 u leave, from the lines alone."""
    true, read, own = lines(rig, 0, frequency)
    together, alone = np.sum(read), np.sum(own)
    share = weight / (1.0 + (together / alone - 1.0) * weight)
    u = -share * (read[IMAGES] / true[IMAGES]) / alone  # D = 1
    power = np.abs(true * u) ** 2
    power[IMAGES] = abs(1.0 + true[IMAGES] * u) ** 2
    return 10 * np.log10(power.sum())


@pytest.mark.parametrize('rig', RIGS)
@pytest.mark.parametrize(('frequency', 'period'), [(10.0, 10), (20.0, 5), (12.5, 8)])
def test_the_weighted_law_is_as_good_as_the_best_periodic_command(rig, frequency, period):
    """Truth: least squares over all voltages of that period, on the plant's own fine grid. 0.1 dB: its 4 kHz against
    the lines up to 6 kHz. Without the weight the law of the samples is worse."""
    rig = load_rig(*RIGS[rig])
    best = best_command(rig, frequency, period)[0]
    assert left(rig, frequency, payload_weight(rig, frequency)[0]) == pytest.approx(best, abs=0.1)
    assert left(rig, frequency, 1.0) > best + 0.2


def test_the_samples_fold_all_lines_onto_the_tone():
    """Truth: the exact sampled model of the strut; 1e-3, the lines beyond 6 kHz."""
    for name, changes in RIGS.values():
        rig = load_rig(name, changes)
        for frequency in (6.5, 10.0, 31.0):
            folded = np.sum(lines(rig, 0, frequency)[2])
            exact = strut_response(rig, 0, np.array([frequency]))[0]
            assert_allclose(folded, exact, rtol=1e-3)


def test_a_fast_rig_needs_no_weight():
    """Truth: at 1 kHz with a linear hold the images of 10 Hz are smaller by (10 / 990)^2; the weight is 1."""
    rig = load_rig('clean_3dof', {'acquisition.sample_rate': 1000.0, 'acquisition.hold': 'linear'})
    assert abs(payload_weight(rig, 10.0)[0] - 1.0) < 0.02


def test_a_slow_hold_is_a_wire():
    rig = load_rig('paper_3dof', {'acquisition.input_delay': 0.0})
    assert_allclose(hold_response(rig.acquisition, 0.01), 1.0, atol=1e-3)


def test_the_table_is_rows_of_three():
    rig = load_rig('paper_3dof')
    table = np.reshape(weight_table(rig, 5.0, 40.0, size=4), (4, 3))
    assert_allclose(table[:, 0], [5.0, 10.0, 20.0, 40.0])
    assert_allclose(table[:, 1] + 1j * table[:, 2], payload_weight(rig, table[:, 0]))
