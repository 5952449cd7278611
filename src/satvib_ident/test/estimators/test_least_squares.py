# SPDX-FileCopyrightText: 2026 The satvib authors
# SPDX-License-Identifier: Apache-2.0
"""Recursive estimators against batch solutions, bias from noise, and regressors made to break them."""

import numpy as np
import pytest
from satvib_common.errors import SatvibError
from satvib_ident.estimators.extended import ExtendedLeastSquares
from satvib_ident.estimators.instrumental import InstrumentalVariable
from satvib_ident.estimators.least_squares import RecursiveLeastSquares
from satvib_ident.forgetting import (
    CovarianceResetting,
    DeadZone,
    DirectionalForgetting,
    ExponentialForgetting,
    FiniteWindow,
    NoForgetting,
    VariableRateForgetting,
)

RULES = {
    'none': NoForgetting,
    'exponential': lambda: ExponentialForgetting(0.98),
    'variable_rate': VariableRateForgetting,
    'directional': lambda: DirectionalForgetting(0.98, test=VariableRateForgetting()),
    'resetting': lambda: CovarianceResetting(1e-4, 1.0),
    'dead_zone': lambda: DeadZone(0.01),
    'window': lambda: FiniteWindow(30),
}


def test_no_forgetting_is_batch_least_squares_with_its_covariance(
    feed, records, batch_least_squares
):
    """Truth: scipy.linalg.lstsq (1e-9), the residual variance and (W^T W)^-1 of the same rows (1e-9)."""
    y, u = records(1, 500, 0.005, 21)
    theta, W, target = batch_least_squares(y[0], u[0], 2, 3)
    e = feed(RecursiveLeastSquares(5), y[0], u[0])
    np.testing.assert_allclose(e.theta, theta, rtol=1e-9)
    variance = np.sum((target - W @ theta) ** 2) / (len(target) - 5)
    assert float(e.noise_variance) == pytest.approx(variance, rel=1e-9)
    np.testing.assert_allclose(e.covariance, variance * np.linalg.inv(W.T @ W), rtol=1e-9)


@pytest.mark.parametrize('order', [2, 4, 6])
def test_the_robot_arm_with_any_initial_covariance_large_enough(
    feed, robot_arm, batch_least_squares, order
):
    """Truth: scipy's batch solution; 1e18 and 1e24 alike within 1e-9 relative, because U D U^T does not cancel."""
    u, y = robot_arm
    theta, _, _ = batch_least_squares(y, u, order, order + 1)
    for start in (1e18, 1e24):
        estimator = RecursiveLeastSquares(2 * order + 1, initial_covariance=start)
        e = feed(estimator, y, u, order, order + 1)
        np.testing.assert_allclose(e.theta, theta, rtol=1e-9, atol=1e-9 * np.abs(theta).max())


def test_exponential_forgetting_is_the_weighted_batch_solution(feed, records, batch_least_squares):
    """Truth: scipy.linalg.lstsq with rows weighted by lambda^(age/2) (1e-8)."""
    y, u = records(1, 400, 0.005, 22)
    weight = 0.97 ** np.arange(len(y[0]) - 1, -1, -1)
    theta, _, _ = batch_least_squares(y[0], u[0], 2, 3, weight=weight)
    rule = ExponentialForgetting(0.97)
    e = feed(RecursiveLeastSquares(5, (), rule, limit=1e40), y[0], u[0])
    np.testing.assert_allclose(e.theta, theta, rtol=1e-8)


def test_a_known_start_is_the_regularized_batch_solution(feed, records, batch_least_squares):
    """Truth: minimum of |y - W theta|^2 + |theta - theta0|^2 / P0, by the normal equations (1e-10)."""
    y, u = records(1, 60, 0.005, 23)
    _, W, target = batch_least_squares(y[0], u[0], 2, 3)
    start, P0 = np.array([-0.3, 0.1, 0.0, 0.0, 0.0]), 0.5
    expected = np.linalg.solve(W.T @ W + np.eye(5) / P0, W.T @ target + start / P0)
    e = feed(RecursiveLeastSquares(5, initial_covariance=P0, initial_theta=start), y[0], u[0])
    np.testing.assert_allclose(e.theta, expected, rtol=1e-10)


def test_a_finite_window_is_the_batch_solution_of_its_samples(feed, records, batch_least_squares):
    """Truth: scipy.linalg.lstsq over the last 120 rows (1e-8), after more than three rounds of the window."""
    y, u = records(1, 500, 0.005, 24)
    theta, _, _ = batch_least_squares(y[0][-122:], u[0][-122:], 2, 3)
    e = feed(RecursiveLeastSquares(5, (), FiniteWindow(120)), y[0], u[0])
    np.testing.assert_allclose(e.theta, theta, rtol=1e-8)


def test_confidence_intervals_hold_what_they_promise(feed, paper):
    """Truth: with white equation noise 95 % of 400 records lie within 1.96 deviations (4 sigma of that: 4.4 %)."""
    generator = np.random.default_rng([25])
    u = generator.choice([-1.0, 1.0], size=(400, 300))
    y = np.zeros_like(u)
    noise = 0.01 * generator.normal(size=u.shape)
    for k in range(2, 300):
        past = np.stack([-y[:, k - 1], -y[:, k - 2], u[:, k], u[:, k - 1], u[:, k - 2]], axis=-1)
        y[:, k] = past @ paper.theta + noise[:, k]
    e = feed(RecursiveLeastSquares(5, (400,)), y, u)
    deviation = np.sqrt(np.diagonal(e.covariance, axis1=-2, axis2=-1))
    inside = np.mean(np.abs(e.theta - paper.theta) < 1.96 * deviation, axis=0)
    assert (np.abs(inside - 0.95) < 0.044).all()


def test_the_bias_of_sensor_noise_goes(feed, records, paper):
    """Truth: the model that made 200 records (PRBS +-1 V, noise 0.005 on the output). Least squares is off by more
    than 0.1 in a1 on average, extended least squares and the instrumental variable by less than 0.02.
    """
    y, u = records(200, 500, 0.005, 26)
    bias = {}
    for name, estimator in (
        ('least squares', RecursiveLeastSquares(5, (200,))),
        ('extended', ExtendedLeastSquares(5, 2, (200,))),
        ('instrumental', InstrumentalVariable(2, 3, 2, (200,))),
    ):
        feed(estimator, y, u)
        bias[name] = float(np.mean(estimator.theta[:, 0] - paper.a[0]))
    assert bias['least squares'] > 0.1
    assert abs(bias['extended']) < 0.02
    assert abs(bias['instrumental']) < 0.02


def test_the_instrumental_variable_knows_its_own_spread(feed, records, paper):
    """Truth: the spread of a1 over 200 records against the mean predicted deviation; 20 % is 4 sigma of the former."""
    y, u = records(200, 600, 0.005, 27)
    e = feed(InstrumentalVariable(2, 3, 2, (200,)), y, u)
    spread = np.std(e.theta[:, 0] - paper.a[0])
    predicted = np.mean(np.sqrt(e.covariance[:, 0, 0]))
    assert predicted == pytest.approx(spread, rel=0.2)


def test_without_noise_every_estimator_finds_the_plant(feed, records, paper):
    """Truth: the five parameters that made the record (1e-6)."""
    y, u = records(1, 300, 0.0, 28)
    for estimator in (
        RecursiveLeastSquares(5, (1,)),
        ExtendedLeastSquares(5, 2, (1,)),
        InstrumentalVariable(2, 3, 2, (1,)),
    ):
        np.testing.assert_allclose(feed(estimator, y, u).theta[0, :5], paper.theta, atol=1e-6)


def adversary(generator, streams, count):
    """Regressors that have broken others: zeros, repeats, tiny, huge, collinear, mixed, not finite."""
    w = generator.normal(size=(streams, count))
    kind = np.arange(streams) % 8
    w[kind == 0] = 0.0
    w[kind == 1] = 1.0
    w[kind == 2] *= 1e-300
    w[kind == 3] *= 1e12
    w[kind == 4] = w[kind == 4][:, :1] * np.arange(1.0, count + 1.0)
    w[kind == 5] *= 10.0 ** generator.integers(-12, 13, size=(np.sum(kind == 5), count))
    w[kind == 6] = np.where(
        generator.random((np.sum(kind == 6), count)) < 0.05, np.nan, w[kind == 6]
    )
    y = generator.normal(size=streams) * 10.0 ** generator.integers(-6, 7, size=streams)
    y[generator.random(streams) < 0.01] = np.inf
    return w, y


@pytest.mark.parametrize('name', list(RULES))
@pytest.mark.parametrize(
    'updates',
    [pytest.param(400, id='short'), pytest.param(10_500, id='long', marks=pytest.mark.long)],
)
def test_nothing_breaks_an_estimator(name, updates):
    """Truth: theta and P stay finite, P equals its transpose to the last bit and has a Cholesky factor.

    The long form makes ten million updates of each rule.
    """
    streams = 960
    generator = np.random.default_rng([29, updates])
    e = RecursiveLeastSquares(5, (streams,), RULES[name](), limit=1e6)
    for k in range(updates):
        e.update(*adversary(generator, streams, 5))
        if k % 100 == 99:
            P = e.P
            assert np.isfinite(e.theta).all()
            assert np.array_equal(P, np.swapaxes(P, -1, -2))
            np.linalg.cholesky(P)
    assert (e.updates + e.refused > 0.9 * updates).any()
    assert e.updates[6] < updates


@pytest.mark.parametrize('make', [ExtendedLeastSquares, InstrumentalVariable])
def test_nothing_breaks_the_noise_honest_either(make):
    """Truth: the same, for estimators that keep signals of their own."""
    generator = np.random.default_rng([30])
    e = make(2, 3, 2, (960,)) if make is InstrumentalVariable else make(5, 2, (960,))
    for _ in range(300):
        w, y = adversary(generator, 960, 5)
        known = np.isfinite(w).all(axis=-1)
        e.interrupt(~known)
        e.update(np.where(known[:, None], w, 0.0), y, known)
    assert np.isfinite(e.theta).all()
    np.linalg.cholesky(e.P)


def test_padasips_rls_fails_where_this_one_does_not():
    """Truth: padasip at lambda 0.98 is not finite six minutes after excitation stops; the limit holds P here."""
    padasip = pytest.importorskip('padasip')
    theirs, ours = (
        padasip.filters.FilterRLS(2, mu=0.98),
        RecursiveLeastSquares(2, (), ExponentialForgetting(0.98), limit=1e6),
    )
    generator = np.random.default_rng([31])
    with np.errstate(all='ignore'):
        for k in range(37_000):
            w = generator.normal(size=2) if k < 400 else np.zeros(2)
            theirs.adapt(w @ [1.0, 2.0], w)
            ours.update(w, np.asarray(w @ [1.0, 2.0]))
    assert not np.isfinite(theirs.R).all()
    np.testing.assert_allclose(ours.theta, [1.0, 2.0], rtol=1e-9)
    assert np.trace(ours.P) < 1.1e6


def test_bits_do_not_depend_on_the_shape(records, feed):
    """Truth: a record alone and the same record among 50 give the same bits, for every rule and estimator."""
    y, u = records(50, 300, 0.005, 32)
    makers = [lambda shape, n=name: RecursiveLeastSquares(5, shape, RULES[n]()) for name in RULES]
    makers += [
        lambda shape: ExtendedLeastSquares(5, 2, shape, VariableRateForgetting()),
        lambda shape: InstrumentalVariable(2, 3, 2, shape, ExponentialForgetting(0.99)),
    ]
    for make in makers:
        whole, one = feed(make((50,)), y, u), feed(make(()), y[17], u[17])
        assert np.array_equal(whole.theta[17], one.theta)
        assert np.array_equal(whole.P[17], one.P)


def test_reset_and_inactive_samples(records, feed):
    """Truth: an inactive sample changes no bit; a reset item equals a new one, its neighbour stays."""
    y, u = records(2, 100, 0.005, 33)
    e = feed(RecursiveLeastSquares(5, (2,), ExponentialForgetting(0.98)), y, u)
    theta, P = e.theta.copy(), e.P
    e.update(np.ones((2, 5)), np.ones(2), np.array([False, False]))
    assert np.array_equal(e.theta, theta)
    assert np.array_equal(e.P, P)
    e.reset(np.array([True, False]))
    fresh = RecursiveLeastSquares(5, (2,))
    assert np.array_equal(e.P[0], fresh.P[0])
    assert np.array_equal(e.theta[0], fresh.theta[0])
    assert np.array_equal(e.theta[1], theta[1])
    assert (e.updates[0], e.updates[1]) == (0, 98)


@pytest.mark.parametrize(
    ('make', 'message'),
    [
        (lambda: RecursiveLeastSquares(0), '0 parameters'),
        (lambda: RecursiveLeastSquares(2, initial_covariance=0.0), 'not positive'),
        (lambda: RecursiveLeastSquares(2, initial_theta=[1.0, np.nan]), 'finite numbers'),
        (lambda: RecursiveLeastSquares(3, initial_theta=[1.0, 2.0]), '3 finite numbers'),
        (lambda: ExponentialForgetting(0.0), r'0.0 is not in \(0, 1\]'),
        (lambda: ExponentialForgetting(1.0001), r'1.0001 is not in'),
        (lambda: DirectionalForgetting(np.nan), 'not in'),
        (lambda: DirectionalForgetting(0.9, -1.0), 'regressor_floor'),
        (lambda: VariableRateForgetting(0, 10), 'windows of 0'),
        (lambda: VariableRateForgetting(confidence=1.0), 'confidence'),
        (lambda: CovarianceResetting(2.0, 1.0), 'reset_threshold'),
        (lambda: DeadZone(-0.1), 'dead_zone'),
        (lambda: FiniteWindow(0), 'window'),
        (lambda: ExtendedLeastSquares(5, 0), 'noise_coefficients'),
    ],
)
def test_bad_settings_are_refused_by_name(make, message):
    """Truth: each setting lies outside its documented range."""
    with pytest.raises(SatvibError, match=message):
        make()
