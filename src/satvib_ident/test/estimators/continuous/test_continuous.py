# SPDX-FileCopyrightText: 2026 The satvib authors
# SPDX-License-Identifier: Apache-2.0
"""Continuous time: the paper's first-order example, its differential equations, and the way back to samples."""

import numpy as np
import pytest
import scipy.signal
from satvib_common.errors import SatvibError
from satvib_ident.estimators.continuous import (
    ContinuousLeastSquares,
    ContinuousRegressor,
    GradientEstimator,
)
from satvib_ident.estimators.continuous.discretize import discretize, discretized_covariance
from satvib_ident.estimators.continuous.filter import StateVariableFilter
from satvib_ident.forgetting import CovarianceResetting
from scipy.integrate import solve_ivp

AP, KP, DT = 2.0, 3.0, 2e-3


@pytest.fixture(scope='module')
def first_order():
    """The paper's Eq. (1) with a_p = 2, k_p = 3 under two square waves, 14 s: exact samples y, u (held before each)."""
    t = np.arange(7_000) * DT
    u = np.sign(np.sin(2 * np.pi * t + 0.1)) + 0.5 * np.sign(np.sin(2 * np.pi * 0.37 * t + 0.2))
    y = np.zeros_like(u)
    decay = np.exp(-AP * DT)
    for k in range(1, len(u)):
        y[k] = decay * y[k - 1] + KP / AP * (1 - decay) * u[k]
    return y, u


ESTIMATORS = {
    'gradient': lambda: GradientEstimator(2, DT, gain=50.0),
    'least squares': lambda: ContinuousLeastSquares(2, DT),
    'normalized': lambda: ContinuousLeastSquares(
        2, DT, gain=100.0, normalization=1.0, initial_covariance=1e3
    ),
    'resetting': lambda: ContinuousLeastSquares(
        2, DT, forgetting=CovarianceResetting(0.5, 100.0), initial_covariance=100.0
    ),
}


@pytest.mark.parametrize('name', list(ESTIMATORS))
def test_the_papers_first_order_example(first_order, name):
    """Truth: a_p and k_p (1e-3), from y and r alone: no derivative is measured."""
    y, u = first_order
    e, regressor = ESTIMATORS[name](), ContinuousRegressor(1, 1, 5.0, DT)
    for k in range(len(u)):
        w, target, full = regressor.step(y[k], u[k], 0.0)
        e.update(w, target, full)
    np.testing.assert_allclose(e.theta, [AP, KP], atol=1e-3)


@pytest.mark.parametrize('name', ['least squares', 'normalized'])
def test_a_measured_derivative_does_as_well(first_order, name):
    """Truth: Eqs. (2), (3) with y' = -a_p y + k_p r by itself (1e-3)."""
    y, u = first_order
    e = ESTIMATORS[name]()
    for k in range(0, len(u), 10):
        e.update(np.array([-y[k], u[k]]), np.asarray(-AP * y[k] + KP * u[k]))
    np.testing.assert_allclose(e.theta, [AP, KP], atol=1e-3)


@pytest.mark.parametrize(('g', 'mu'), [(1.0, 0.0), (0.7, 2.0), (30.0, 0.01)])
def test_a_sample_is_integrated_exactly(g, mu):
    """Truth: scipy's Runge-Kutta on Eq. (18) itself with w and y held for 0.3 s (rtol 1e-12); 1e-9."""
    w, y, P0, theta0 = np.array([1.0, -2.0]), 0.7, np.array([3.0, 5.0]), np.array([0.2, 0.1])

    def slope(_, x):
        P, theta = x[:4].reshape(2, 2), x[4:]
        q, e1 = w @ P @ w, w @ theta - y
        dP = -g * P @ np.outer(w, w) @ P / (1 + mu * q)
        return np.concatenate([dP.ravel(), -g * P @ w * e1 / (1 + mu * q)])

    start = np.concatenate([np.diag(P0).ravel(), theta0])
    end = solve_ivp(slope, (0, 0.3), start, method='DOP853', rtol=1e-12, atol=1e-14).y[:, -1]
    e = ContinuousLeastSquares(
        2, 0.3, gain=g, normalization=mu, initial_covariance=P0, initial_theta=theta0
    )
    e.update(w, np.asarray(y))
    np.testing.assert_allclose(e.P.ravel(), end[:4], rtol=1e-9, atol=1e-12)
    np.testing.assert_allclose(e.theta, end[4:], rtol=1e-9)


def test_a_gradient_step_is_integrated_exactly():
    """Truth: e1 decays as exp(-g |w|^2 t), by hand; a step of any size lands on the error's line and not beyond."""
    w, theta0 = np.array([1.0, -2.0]), np.array([0.2, 0.1])
    for gain in (1e-9, 0.5, 1e6):
        e = GradientEstimator(2, 0.3, gain=gain, initial_theta=theta0)
        error = float(e.update(w, np.asarray(0.7)))
        assert 0.7 - w @ e.theta == pytest.approx(error * np.exp(-gain * 5.0 * 0.3), abs=1e-12)


@pytest.mark.parametrize('order', [1, 2, 3])
def test_the_filter_is_exact_for_held_and_for_straight_signals(order):
    """Truth: scipy.signal.lsim of c^n s^i / (s + c)^n, which is exact for both (1e-9 of the largest)."""
    c, dt = 2 * np.pi * 8.0, 0.004
    x = np.random.default_rng([51]).normal(size=60)
    t = np.arange(60) * dt
    bottom = np.poly([-c] * order)
    for held in (True, False):
        ours = StateVariableFilter(order, 8.0, dt, held)
        got = np.array([ours.step(np.asarray(v)) for v in x])
        for i in range(order):
            top = np.concatenate([[c**order], np.zeros(i)])
            if held:  # lsim holds each value over the period after it, ours over the period before
                shifted = np.append(x[1:], 0.0)
                first = StateVariableFilter(order, 8.0, dt, held)
                start = first.step(np.asarray(x[0]))
                _, expected, _ = scipy.signal.lsim((top, bottom), shifted, t, interp=False)
                free = np.array([first.step(np.asarray(0.0))[i] for _ in range(59)])
                expected[1:] += free
                expected[0] = start[i]
            else:
                _, expected, _ = scipy.signal.lsim(
                    (top, bottom), np.append(0.0, x), np.arange(61) * dt
                )
                expected = expected[1:]
            np.testing.assert_allclose(got[:, i], expected, atol=1e-9 * np.abs(expected).max())


@pytest.mark.parametrize('order', [1, 2, 3, 4])
def test_discretization_equals_scipys(order):
    """Truth: scipy's zero-order hold of the same fraction, its input one sample later, its D at once (1e-9)."""
    generator = np.random.default_rng([52, order])
    for m in range(1, order + 2):
        alpha = np.poly(-generator.uniform(1, 100, order))[1:]
        beta = 100.0 * generator.normal(size=m)
        A = np.vstack([-alpha, np.eye(order)[:-1]])
        full = np.concatenate([np.zeros(order + 1 - m), beta])
        C, D = full[1:] - full[0] * alpha, full[0]
        B = np.eye(order)[:, :1]
        Phi, Gamma, *_ = scipy.signal.cont2discrete((A, B, C[None], np.array([[D]])), 0.01)
        impulse = [C @ np.linalg.matrix_power(Phi, i) @ Gamma[:, 0] for i in range(order + 1)]
        impulse[0] += D
        a = np.poly(Phi)
        expected = np.concatenate([a[1:], np.convolve(a, impulse)[: order + 1]])
        ours = discretize(np.concatenate([alpha, beta]), order, 0.01)
        np.testing.assert_allclose(ours, expected, rtol=1e-9, atol=1e-11)


def test_covariance_goes_with_the_model():
    """Truth: the spread of 4000 random draws through the same map; 4 sigma of a variance from 4000 draws is 9 %."""
    theta = np.array([200.0, 17_000.0, 1.0, 3.0, 20.0])
    root = np.diag([0.4, 40.0, 0.002, 0.01, 0.1])
    draws = theta + np.random.default_rng([53]).normal(size=(4000, 5)) @ root
    expected = np.var(discretize(draws, 2, 0.01), axis=0)
    ours = discretized_covariance(theta, root**2, 2, 0.01)
    np.testing.assert_allclose(np.diag(ours), expected, rtol=0.09)


def test_a_break_in_the_record_starts_the_filters_anew():
    """Truth: after a NaN nothing is used until the settling time has passed, and the estimate stays finite."""
    regressor = ContinuousRegressor(2, 3, 10.0, 0.01)
    full = [bool(regressor.step(np.asarray(1.0), np.asarray(0.0), 0.0)[2]) for _ in range(60)]
    assert full[-1]
    assert full.index(True) == 20  # (8 + 4) / (2 pi 10 0.01) = 19.1 samples
    w, target, used = regressor.step(np.asarray(np.nan), np.asarray(0.0), 0.0)
    assert not used
    assert np.isfinite(w).all()
    assert np.isfinite(target)
    assert not regressor.step(np.asarray(1.0), np.asarray(0.0), 0.0)[2]


@pytest.mark.parametrize(
    ('make', 'message'),
    [
        (lambda: ContinuousRegressor(0, 1, 5.0, 0.01), '0 poles'),
        (lambda: ContinuousRegressor(1, 3, 5.0, 0.01), '3 coefficients'),
        (lambda: ContinuousRegressor(1, 1, 60.0, 0.01), 'filter_corner: 60.0'),
        (lambda: ContinuousLeastSquares(2, 0.01, gain=0.0), 'gain 0.0'),
        (lambda: ContinuousLeastSquares(2, 0.01, normalization=-1.0), 'normalization -1.0'),
        (lambda: GradientEstimator(2, 0.01, gain=-1.0), 'gain -1.0'),
        (lambda: StateVariableFilter(0, 1.0, 0.01, True), 'order 0'),
    ],
)
def test_bad_settings_are_refused_by_name(make, message):
    """Truth: each setting lies outside its documented range."""
    with pytest.raises(SatvibError, match=message):
        make()
