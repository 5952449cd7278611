# SPDX-FileCopyrightText: 2026 The satvib authors
# SPDX-License-Identifier: Apache-2.0
"""The grid of the truth follows the highest frequency; a tone has the amplitude that it states, whatever it is."""

import math

import numpy as np
import pytest
from satvib_common.errors import SatvibError
from satvib_plant_sim.disturbance.factory import make_disturbance
from satvib_plant_sim.nodes.parameters import PlantParameters
from satvib_plant_sim.plant.plant import Plant
from satvib_plant_sim.rig.fine_grid import POINTS_PER_PERIOD, fitted_grid, highest_mode
from satvib_plant_sim.rig.rig import load_rig, rig_names


def tone(frequency, **more):
    return make_disturbance({'kind': 'sine', 'amplitude': 1.0, 'frequency': frequency, **more})


def lower_amplitude(rig, frequency, seconds=0.6):
    """Amplitude of the lower plate's tone in truth, least squares over the last third."""
    plant = Plant(rig, tone(frequency), 1)
    samples = round(seconds * rig.acquisition.sample_rate)
    truth = np.concatenate([plant.advance(np.zeros(plant.struts)).lower[0] for _ in range(samples)])
    late = np.arange(2 * len(truth) // 3, len(truth))
    angle = 2.0 * math.pi * frequency * plant.fine_period * late
    basis = np.column_stack([np.cos(angle), np.sin(angle)])
    return float(np.hypot(*np.linalg.lstsq(basis, truth[late], rcond=None)[0]))


@pytest.mark.parametrize('frequency', [60.0, 100.0, 130.0, 500.0, 1000.0, 1900.0])
def test_the_lower_plate_has_the_amplitude_that_is_stated(frequency):
    """Truth: 1 m/s^2. A straight line between 40 points of a period has sinc^2(1 / 40) = 0.99795 of the tone."""
    rig = fitted_grid(load_rig('clean_1dof'), [tone(frequency)])
    assert lower_amplitude(rig, frequency) == pytest.approx(1.0, abs=2.5e-3)


def test_a_grid_that_is_too_coarse_is_refused_by_the_plant():
    """Truth: 40 points of 500 Hz are 20 000 per second."""
    with pytest.raises(SatvibError, match=r'500\.0 Hz needs a truth of 20000 points per second'):
        Plant(load_rig('clean_1dof'), tone(500.0), 1)


@pytest.mark.parametrize('name', rig_names())
def test_a_rig_whose_grid_is_fine_enough_stays_as_it_is(name):
    """Truth: 4000 points per second are 40 in a period of 100 Hz, and 17 in one of the highest mode, 225 Hz."""
    rig = load_rig(name)
    assert fitted_grid(rig, [tone(100.0), make_disturbance({'kind': 'none'})]) is rig


@pytest.mark.parametrize(
    ('disturbance', 'highest'),
    [
        ({'kind': 'sweep', 'amplitude': 1, 'frequency': 5, 'end_frequency': 400, 'duration': 1}, 400.0),
        ({'kind': 'random', 'rms': 1, 'low': 5, 'high': 300}, 300.0),
        ({'kind': 'pulse', 'amplitude': 1, 'duration': 0.001}, 500.0),
        ({'kind': 'burst', 'amplitude': 1, 'frequency': 250, 'decay': 0.1}, 250.0),
        ({'kind': 'trapezoid', 'amplitude': 1, 'rise': 1e-9, 'hold': 0.002, 'fall': 1e-9}, 250.0),
        ({'kind': 'sum', 'terms': [{'kind': 'sine', 'amplitude': 1, 'frequency': 150}]}, 150.0),
    ],
)  # fmt: skip
def test_the_grid_follows_every_kind(disturbance, highest):
    rig = load_rig('paper_1dof')
    fitted = fitted_grid(rig, [tone(10.0), make_disturbance(disturbance)])
    rate = fitted.acquisition.fine_steps * fitted.acquisition.sample_rate
    assert POINTS_PER_PERIOD * highest <= rate * (1.0 + 1e-6)
    assert rate < POINTS_PER_PERIOD * highest * 1.001 + fitted.acquisition.sample_rate
    assert fitted.replace(acquisition=rig.acquisition) == rig


def test_the_grid_follows_the_highest_mode():
    """Truth: the shaker's frequency grows with the root of its stiffness."""
    rig = load_rig('clean_1dof')
    stiff = rig.replace(shaker=rig.shaker.replace(stiffness=100.0 * rig.shaker.stiffness))
    assert highest_mode(stiff) == pytest.approx(10.0 * highest_mode(rig), rel=0.02)
    rate = fitted_grid(stiff, []).acquisition.fine_rate
    assert rate >= 10.0 * highest_mode(stiff)


@pytest.mark.parametrize('frequency', [2000.0, 4010.0])
def test_what_the_stated_grid_cannot_hold_is_refused(frequency):
    with pytest.raises(SatvibError, match=rf'frequency: {frequency} Hz is not below 2000\.0 Hz'):
        fitted_grid(load_rig('paper_1dof'), [tone(frequency)])


def test_a_pulse_between_two_points_is_refused():
    """Truth: by hand: 0.2 ms are shorter than 1/4000 s; without a word nothing would happen at all."""
    pulse = make_disturbance({'kind': 'pulse', 'amplitude': 1, 'duration': 0.0002})
    with pytest.raises(SatvibError, match=r'duration: 2500\.0 Hz'):
        fitted_grid(load_rig('paper_1dof'), [pulse])


def test_the_node_has_the_same_grid():
    """Truth: the function itself; failures count too."""
    parameters = PlantParameters(
        rig='paper_1dof',
        disturbance='{kind: sine, amplitude: 1, frequency: 10}',
        failures='[{kind: disturbance_changed, time: 1, disturbance: {kind: sine, amplitude: 1, frequency: 500}}]',
    )
    assert parameters.load_rig() == fitted_grid(load_rig('paper_1dof'), [tone(500.0)])
