# SPDX-FileCopyrightText: 2026 The satvib authors
# SPDX-License-Identifier: Apache-2.0
"""Readings at the ends of a sensor's range are marked. Truth: the range of the rig and the reading itself."""

import numpy as np
import pytest
from numpy.testing import assert_array_equal
from satvib_common.errors import SatvibError
from satvib_plant_sim.disturbance import make_disturbance
from satvib_plant_sim.plant.failing_plant import make_failing_plant
from satvib_plant_sim.plant.failures import Failure
from satvib_plant_sim.plant.plant import Plant
from satvib_plant_sim.rig.rig import load_rig

RANGE = 39.2266  # m/s^2, 4 g


def shaken(amplitude):
    return make_disturbance({'kind': 'sine', 'frequency': 10.0, 'amplitude': amplitude})


def run(plant, samples):
    """Readings and marks of all samples at 0 V, each (samples, 2, ..., struts): upper, lower."""
    rest = np.zeros((*plant.shape, plant.struts))
    readings, marks = [], []
    for _ in range(samples):
        s = plant.sample()
        readings.append([s.upper, s.lower])
        marks.append([s.upper_clipped, s.lower_clipped])
        plant.advance(rest)
    return np.array(readings), np.array(marks)


def test_a_reading_is_marked_where_the_sensor_stands_at_its_end():
    """Truth: without bias, noise and converter a reading is the acceleration limited to 4 g; the last 0.5 % count."""
    changes = {
        'accelerometer.bias': [0.0] * 6, 'accelerometer.noise_rms': 0.0, 'acquisition.input_bits': 0,
    }  # fmt: skip
    rig = load_rig('paper_3dof', changes)
    readings, marks = run(Plant(rig, shaken(1.3 * RANGE), 1), 300)
    assert np.abs(readings).max() == pytest.approx(rig.accelerometer.range, rel=1e-12)
    assert_array_equal(marks, np.abs(readings) >= 0.995 * rig.accelerometer.range)
    assert marks.any(axis=(0, 2)).all()
    assert not marks.all(axis=(0, 2)).any()


def test_nothing_is_marked_inside_the_range():
    """Truth: 2 g are inside 4 g; the paper's converter reads 0.5 to 4.5 V of +-5 V at 4 g, so it never rails."""
    _, marks = run(Plant(load_rig('paper_3dof'), shaken(0.5 * RANGE), 1), 300)
    assert not marks.any()


def test_the_ends_of_the_converter_count_too():
    """Truth: a converter of +-3 V has its end at 0.5 V above a sensor that rests at 2.5 V: 1 g."""
    rig = load_rig('paper_3dof', {'acquisition.input_range': 3.0, 'accelerometer.bias': [0.0] * 6})
    readings, marks = run(Plant(rig, shaken(2.0 * 9.80665), 1), 300)
    assert marks.any()
    assert readings[marks].min() > 0.9 * 9.80665
    assert not marks[readings < 0.9 * 9.80665].any()


def test_a_trial_of_a_batch_has_the_marks_of_its_single_run():
    rig = load_rig('paper_3dof')
    levels = [0.5 * RANGE, 1.3 * RANGE]
    _, batch = run(Plant(rig, [shaken(a) for a in levels], [1, 2]), 100)
    for trial, (level, seed) in enumerate(zip(levels, [1, 2], strict=True)):
        _, single = run(Plant(rig, shaken(level), seed), 100)
        assert_array_equal(batch[:, :, trial], single)


def test_a_range_that_changes_in_a_run_moves_the_marks():
    """Truth: 1 g is inside 4 g and outside 0.5 g; a lost sensor shows nothing, so it is not marked."""
    failures = [
        Failure(kind='rig_changed', time=1.0, changes={'accelerometer.range': 4.9}),
        Failure(kind='sensor_lost', strut=2, time=2.0),
    ]
    rig = load_rig('paper_3dof')
    plant = make_failing_plant(rig, shaken(9.8), 1, failures)
    _, marks = run(plant, 300)
    rate = round(rig.acquisition.sample_rate)
    assert not marks[:rate].any()
    assert marks[rate : 2 * rate].any(axis=0).all()
    assert not marks[2 * rate :, 0, 1].any()
    assert marks[2 * rate :, 0, 0].any()


def test_a_range_of_nothing_is_refused():
    with pytest.raises(SatvibError, match=r'accelerometer\.range'):
        load_rig('paper_3dof', {'accelerometer.range': 0.0})
