# SPDX-FileCopyrightText: 2026 The satvib authors
# SPDX-License-Identifier: Apache-2.0
"""Stiffness, modes and the free response of the payload."""

import numpy as np
import pytest
from numpy.testing import assert_allclose
from satvib_plant_sim.disturbance import make_disturbance
from satvib_plant_sim.physics.mechanics import mechanics
from satvib_plant_sim.physics.modes import (
    equilibrium,
    free_response,
    modal_frequencies,
    static_stiffness,
    strut_modes,
)
from satvib_plant_sim.plant.plant import Plant
from satvib_plant_sim.rig.rig import load_rig
from scipy.linalg import eigh, expm

QUIET = {
    'accelerometer.noise_rms': 0.0,
    'accelerometer.zero_tolerance': 0.0,
    'acquisition.input_bits': 0,
    'acquisition.output_bits': 0,
}


def independent(rig):
    """M and K of the payload from its potential and kinetic energy, strut by strut."""
    K = np.zeros((3, 3))
    for i, scale in enumerate(rig.struts.stiffness_scale):
        angle = np.deg2rad(rig.struts.first_angle + 120.0 * i)
        x, y = rig.struts.radius * np.cos(angle), rig.struts.radius * np.sin(angle)
        row = np.array([1.0, y, -x])
        K += rig.struts.stiffness * scale * np.outer(row, row)
    J = 0.55 * rig.payload.mass * rig.struts.radius**2
    return np.diag([rig.payload.mass, J, J]), K


@pytest.mark.parametrize('name', ['paper_3dof', 'soft_3dof'])
def test_stiffness_and_modes_equal_an_independent_calculation(name):
    """Truth: scipy's generalized eigenproblem on M and K summed strut by strut; 1e-12 relative."""
    rig = load_rig(name)
    M, K = independent(rig)
    assert_allclose(static_stiffness(rig), K, rtol=1e-12, atol=1e-9)
    assert_allclose(modal_frequencies(rig), np.sqrt(eigh(K, M)[0]) / (2 * np.pi), rtol=1e-12)


def test_one_strut_is_a_mass_on_a_spring():
    """Truth: sqrt(K / m) / 2 pi; 1e-12 relative."""
    rig = load_rig('paper_1dof')
    assert_allclose(modal_frequencies(rig), [np.sqrt(49500.0 / 3.0) / (2 * np.pi)], rtol=1e-12)


@pytest.mark.parametrize('name', ['paper_3dof', 'soft_3dof'])
def test_a_constant_force_bends_the_plant_by_the_static_stiffness(name):
    """Truth: K^-1 F from the independent matrices, after the transients; 1e-8 relative."""
    rig = load_rig(name, {**QUIET, 'payload.force_x': 0.03, 'payload.force_y': -0.05})
    push = {'kind': 'trapezoid', 'target': 'payload', 'amplitude': 10.0}
    push |= {'rise': 0.5, 'hold': 1000.0, 'fall': 0.1}
    plant = Plant(rig, make_disturbance(push), 1)
    for _ in range(round(8.0 / plant.dt)):
        truth = plant.advance(np.zeros(3))
    _, K = independent(rig)
    w, alpha, beta = np.linalg.solve(K, 10.0 * np.array([1.0, -0.05, -0.03]))
    angles = np.deg2rad(90.0 + 120.0 * np.arange(3))
    expected = w + 0.15 * (np.sin(angles) * alpha - np.cos(angles) * beta)
    assert_allclose(truth.stroke, expected, rtol=1e-8)
    assert_allclose(truth.upper, 0.0, atol=1e-6)


def test_each_strut_of_the_paper_rig_shows_the_papers_poles():
    """Truth: the paper's wn 131 rad/s within 2 %, zeta 0.79 within 0.03, by a fit to each strut's own w_i."""
    wn, zeta = strut_modes(load_rig('paper_3dof'))
    assert_allclose(wn, 131.0, rtol=0.02)
    assert_allclose(zeta, 0.79, atol=0.03)


def test_soft_rig_is_at_nine_hertz_with_five_percent():
    """Truth: the rig's complex poles, of which the three slowest are the payload's; 8.4-9.1 Hz, 4.5-5.5 %."""
    poles = np.linalg.eigvals(mechanics(load_rig('soft_3dof')).A)
    slow = np.sort_complex(poles[(np.abs(poles) < 100.0) & (poles.imag > 0.0)])
    assert len(slow) == 3
    frequency, damping = np.abs(slow) / (2 * np.pi), -slow.real / np.abs(slow)
    assert_allclose(frequency, 8.75, atol=0.35)
    assert_allclose(damping, 0.05, atol=0.005)


@pytest.mark.parametrize('name', ['paper_3dof', 'paper_1dof', 'soft_3dof'])
def test_the_plant_swings_as_the_continuous_equations_say(name):
    """Truth: the matrix exponential of the equations (no filters, no kernel); 1e-12 of the start."""
    rig = load_rig(name, QUIET)
    plant = Plant(rig, make_disturbance(None), 1)
    n = plant.struts
    x = equilibrium(rig, np.full(n, 1e-3))
    E = expm(mechanics(rig).A * plant.dt)
    plant.displace(1e-3)
    for _ in range(40):
        assert_allclose(plant.advance(np.zeros(n)).stroke, x[:n], rtol=0.0, atol=1e-15)
        x = E @ x


def test_free_response_starts_at_rest_and_dies_out():
    """Truth: the equations' initial condition; a stable rig."""
    times, motion = free_response(load_rig('paper_3dof'), duration=0.3, heave=2e-3)
    # the lower plate has given way by 3 K s / k_s = 1.9 % of the heave
    assert_allclose(motion[:, 0], 2e-3 * (1 + 3 * 49500.0 / 8e6), rtol=1e-9)
    assert_allclose(motion[:, 1], motion[:, 0], rtol=2e-3)
    assert_allclose(motion[:, -1], 0.0, atol=1e-12)
    assert times[1] == 0.25e-3
