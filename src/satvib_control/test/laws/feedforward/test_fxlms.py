# SPDX-FileCopyrightText: 2026 The satvib authors
# SPDX-License-Identifier: Apache-2.0
"""The LMS step: its gradient, its bound, its leak and what an error of the secondary path does to it."""

import numpy as np
import pytest
from satvib_control.laws.feedforward.fxlms import fxlms


def step(regressor, error, weights, power, mu=0.1, leak=0.0, forget=1.0, active=True):
    return fxlms(regressor, error, active, mu, leak, forget, weights, power)


def test_the_step_goes_down_the_gradient():
    """Truth: central differences of (d + w^T phi_f)^2 / 2, in the direction of each weight; 1e-6 relative."""
    rng = np.random.default_rng(1)
    phi, w, d = rng.standard_normal(7), rng.standard_normal(7), 0.7
    cost = lambda v: 0.5 * (d + v @ phi) ** 2  # noqa: E731
    h = 1e-6
    gradient = np.array([(cost(w + h * e) - cost(w - h * e)) / (2 * h) for e in np.eye(7)])
    moved = w.copy()
    step(phi, d + w @ phi, moved, np.zeros(1), mu=0.3)
    np.testing.assert_allclose(w - moved, 0.3 * gradient / (phi @ phi), rtol=1e-6)


@pytest.mark.parametrize('mu', [0.3, 1.0, 1.9, 2.1])
def test_the_step_is_stable_up_to_two(mu):
    """Truth, closed form: with a constant regressor the error is multiplied by 1 - mu each step. 1e-9 relative."""
    phi, w, power = np.array([2.0, -1.0, 0.5]), np.zeros(3), np.zeros(1)
    errors = []
    for _ in range(12):
        errors.append(1.0 + w @ phi)
        step(phi, errors[-1], w, power, mu=mu)
    np.testing.assert_allclose(errors, (1.0 - mu) ** np.arange(12), rtol=1e-9, atol=1e-13)


def test_the_leak_leaves_its_share_of_the_disturbance():
    """Truth, closed form: on one direction with all the power the residual is q / (1 + q) of d. 1e-9 relative."""
    phi, w, power = np.array([3.0, 4.0]), np.zeros(2), np.zeros(1)
    for _ in range(2000):
        step(phi, 2.0 + w @ phi, w, power, mu=0.5, leak=0.05)
    assert 2.0 + w @ phi == pytest.approx(2.0 * 0.05 / 1.05, rel=1e-9)


@pytest.mark.parametrize(
    ('degrees', 'ratio'), [(0, 1.0), (60, 1.5), (85, 1.0), (95, 1.0), (180, 1)]
)
def test_a_path_that_is_wrong_by_an_angle_converges_with_its_cosine(degrees, ratio):
    """A tone, weights on cosine and sine, a path G = ratio e^(j angle) G_hat.

    Truth, closed form (averaging): |E| changes by 1 - mu ratio cos(angle) / 2 a sample. Exponent within 3 % of
    mu ratio / 2 (the average holds for slow steps; mu is 0.01).
    """
    mu, w0, count = 0.01, 2.0 * np.pi * 0.11, 1000
    g_hat = 0.4 * np.exp(0.7j)
    g = ratio * np.exp(1j * np.radians(degrees)) * g_hat
    w, power, residual = np.zeros(2), np.zeros(1), []
    for k in range(count):
        turn = np.exp(1j * w0 * k)
        through = g_hat * turn
        c = complex(w[0], -w[1])
        residual.append(abs(1.0 + g * c))
        e = ((1.0 + g * c) * turn).real
        step(np.array([through.real, through.imag]), e, w, power, mu=mu)
    rate = np.log(residual[-1] / residual[0]) / (count - 1)
    assert rate == pytest.approx(
        -0.5 * mu * ratio * np.cos(np.radians(degrees)), abs=0.03 * 0.5 * mu * ratio
    )


def test_nothing_moves_where_it_is_not_active_or_not_finite():
    """Truth: the weights as they were. Exact."""
    w = np.array([1.0, 2.0])
    power = np.array([0.5])
    for error, active in ((1.0, False), (np.nan, True), (np.inf, True)):
        norm = step(np.array([1.0, 1.0]), error, w, power, active=active)
        assert w.tolist() == [1.0, 2.0]
        assert power[0] == 0.5
        assert norm == 5.0


def test_bits_do_not_depend_on_the_batch():
    """Truth: the items one by one. Exact."""
    rng = np.random.default_rng(2)
    phi, e = rng.standard_normal((50, 4, 3, 9)), rng.standard_normal((50, 4, 3))
    w, power = np.zeros((4, 3, 9)), np.zeros((4, 3, 1))
    for k in range(50):
        step(phi[k], e[k], w, power, leak=0.01, forget=0.2)
    for i in np.ndindex(4, 3):
        alone, p = np.zeros(9), np.zeros(1)
        for k in range(50):
            step(phi[k][i], e[k][i], alone, p, leak=0.01, forget=0.2)
        assert np.array_equal(alone, w[i])
