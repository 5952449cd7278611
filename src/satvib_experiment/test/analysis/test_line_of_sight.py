# SPDX-FileCopyrightText: 2026 The satvib authors
# SPDX-License-Identifier: Apache-2.0
"""Line of sight, from strokes and from accelerations."""

import math
from dataclasses import replace

import numpy as np
import pytest
from satvib_experiment.analysis.line_of_sight import ARC_SECONDS, line_of_sight, tilt_matrix
from satvib_experiment.report.judged import worse_pointing
from satvib_plant_sim.rig.payload_shapes import payload_modes
from satvib_plant_sim.rig.rig import load_rig

DT = 1.0 / 200.0


def tilting(synthetic, rig, amplitude, frequency, seconds=20.0):
    """A run of a payload that tilts about x by a tone of `amplitude` rad and heaves by 1 mm at 3 Hz."""
    t = np.arange(round(seconds / DT)) * DT
    turn = 2 * np.pi * frequency
    motions = np.zeros((len(t), 3))
    motions[:, 1] = amplitude * np.sin(turn * t)
    motions[:, 0] = 1e-3 * np.sin(2 * np.pi * 3.0 * t)
    factor = np.array([-((2 * np.pi * 3.0) ** 2), -(turn**2), 0.0])
    found = payload_modes(rig)
    places = found.strut * np.array([1.0, found.radius, found.radius])
    stroke, upper = motions @ places.T, (motions * factor) @ places.T
    run = synthetic(upper, DT, upper[:, :, None].copy())
    run.groups['truth']['stroke'] = stroke
    return replace(run, rig=rig)


def test_a_known_tilt_is_found_from_both(synthetic):
    """Truth: 20 urad amplitude are 14.14 urad RMS, whatever the heave; 0.5 %."""
    rig = load_rig('soft_3dof')
    run = tilting(synthetic, rig, 20e-6, 11.0)
    found = line_of_sight(run, (0.0, 20.0), 2.0)
    assert found.true == pytest.approx(20e-6 / np.sqrt(2), rel=0.005)
    assert found.measured == pytest.approx(20e-6 / np.sqrt(2), rel=0.005)


def test_what_lies_below_the_stated_frequency_does_not_count(synthetic):
    """Truth: a tilt at 1 Hz, judged above 2 Hz: nothing."""
    run = tilting(synthetic, load_rig('soft_3dof'), 20e-6, 1.0)
    found = line_of_sight(run, (0.0, 20.0), 2.0)
    assert found.true < 1e-9
    assert line_of_sight(run, (0.0, 20.0), 0.5).true == pytest.approx(14.14e-6, rel=0.01)


def test_a_tilt_that_comes_late_counts_as_one_that_is_in_the_middle(synthetic):
    """A burst of 2 s in a stretch of 20 s. Truth: 20 urad amplitude in a tenth of the time, 4.472 urad RMS; 5 %."""
    rig = load_rig('soft_3dof')
    for first in (2.0, 9.0, 16.0):
        run = tilting(synthetic, rig, 20e-6, 11.0)
        inside = (run.time >= first) & (run.time < first + 2.0)
        run.groups['truth']['stroke'] = np.where(inside[:, None], run.get('truth', 'stroke'), 0.0)
        found = line_of_sight(run, (0.0, 20.0), 2.0)
        assert found.true == pytest.approx(20e-6 / np.sqrt(2) * np.sqrt(0.1), rel=0.05)


def test_what_moved_before_a_short_stretch_does_not_count(synthetic):
    """Ten times louder until the stretch begins. Truth: 20 urad amplitude; a stretch that is too short has no figure.

    The filter's edge has a share of 1 / length in the power: 10 % in 6 s is 70 % in 0.7 s.
    """
    run = tilting(synthetic, load_rig('soft_3dof'), 20e-6, 3.5)
    loud = np.where(run.time < 10.0, 10.0, 1.0)[:, None]
    run.groups['truth']['stroke'] = run.get('truth', 'stroke') * loud
    assert line_of_sight(run, (10.0, 10.7), 2.0) is None
    assert line_of_sight(run, (19.3, 30.0), 2.0) is None  # 0.7 s are in the record
    assert line_of_sight(run, (10.0, 11.5), 2.0) is not None
    found = line_of_sight(run, (10.0, 16.0), 2.0)
    assert found.true == pytest.approx(20e-6 / np.sqrt(2), rel=0.12)


def test_the_filter_sees_periods_of_its_own_frequency_around_a_stretch(synthetic):
    """A tilt of 200 urad at 0.3 Hz, judged above 0.5 Hz. Truth: 20 urad amplitude at 11 Hz; 1 %."""
    run = tilting(synthetic, load_rig('soft_3dof'), 20e-6, 11.0, seconds=60.0)
    slow = tilting(synthetic, load_rig('soft_3dof'), 200e-6, 0.3, seconds=60.0)
    for group, name in (('truth', 'stroke'), ('acceleration', 'upper')):
        run.groups[group][name] = run.get(group, name) + slow.get(group, name)
    found = line_of_sight(run, (27.0, 33.0), 0.5)
    assert found.true == pytest.approx(20e-6 / np.sqrt(2), rel=0.01)
    assert found.measured == pytest.approx(20e-6 / np.sqrt(2), rel=0.01)


def test_the_noise_of_the_sensors_is_foretold(synthetic):
    """Truth: white noise of the rig's own level on every sensor, 50 records of 20 s; 10 %."""
    from satvib_plant_sim.physics.noise import noise_floor

    rig = load_rig('soft_3dof')
    rng = np.random.default_rng(1)
    power = []
    for _ in range(50):
        run = replace(synthetic(noise_floor(rig) * rng.normal(size=(4000, 3)), DT), rig=rig)
        found = line_of_sight(run, (0.0, 20.0), 2.0)
        power.append(found.measured**2)
    assert np.sqrt(np.mean(power)) == pytest.approx(found.noise, rel=0.1)
    assert np.isnan(found.true)


def test_one_strut_does_not_tilt():
    """Truth: there is no tilt."""
    assert tilt_matrix(load_rig('paper_1dof')) is None


@pytest.mark.parametrize(
    ('open_loop', 'uncontrolled', 'said'),
    [
        (20.0, None, '43" RMS beside 20" of its open-loop twin'),
        (None, 22.0, '43" RMS beside 22" of the stretch without control'),
        (50.0, 22.0, ''),
        (43.0, None, ''),
        (None, None, ''),
    ],
)
def test_worse_pointing_is_said(open_loop, uncontrolled, said):
    """Truth: by hand; in the same instants the open loop counts, and a level alone says nothing."""
    figures = {'controlled': 43.0, 'open_loop': open_loop, 'uncontrolled': uncontrolled}
    sights = {
        name: None if angle is None else {'true': angle / ARC_SECONDS, 'measured': math.nan}
        for name, angle in figures.items()
    }
    found = ' '.join(worse_pointing({'line_of_sight': sights}))
    assert bool(found) == bool(said)
    assert said in found
