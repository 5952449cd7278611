# SPDX-FileCopyrightText: 2026 The satvib authors
# SPDX-License-Identifier: Apache-2.0
"""What the rules for old data do when the plant changes, and when the excitation stops."""

import numpy as np
import pytest
from satvib_common.phases import Phase
from satvib_ident.estimators.least_squares import RecursiveLeastSquares
from satvib_ident.excitation import make_excitation
from satvib_ident.forgetting import (
    CovarianceResetting,
    DeadZone,
    DirectionalForgetting,
    VariableRateForgetting,
)
from satvib_ident.identifier import IdentifierCore
from satvib_ident.models.iir_model import IirModel
from satvib_ident.parameters import IdentifierParameters

PLANT = IirModel([-0.460, 0.158], [0.061, -0.103, 0.033], 1, 0.01)
CHANGED = IirModel([-0.70, 0.25], [0.05, -0.09, 0.03], 1, 0.01)


def life(forgetting, noise, silence, seeds, **options):
    """Rest for 1 s, excite for 4 s, fall silent, change the plant, excite for 2 s; PRBS of 5 V, noise on the output.

    Returns: a1 at the stop and at the end of the silence, the largest trace of P in the silence, a1 after the change.
    """
    parameters = IdentifierParameters(forgetting=forgetting, measure_period=10**9, **options)
    core = IdentifierCore(parameters, (seeds,))
    signal = make_excitation('prbs', amplitude=5.0, dt=0.01)
    generator = np.random.default_rng([41])
    until = 500 + round(silence * 100)
    u = np.concatenate(
        [np.zeros(100), signal.samples(400), np.zeros(until - 500), signal.samples(900)[700:]]
    )
    y = np.concatenate([PLANT.simulate(u[:until]), CHANGED.simulate(u[until:])])
    trace, stop, end = 0.0, None, None
    for k in range(len(u)):
        out = core.step(
            k,
            Phase.CALIBRATE if k < 100 else Phase.IDENTIFY,
            y[k] + noise * generator.normal(size=seeds),
            np.full(seeds, u[k - 1] if k else 0.0),
        )
        if k == 500:
            stop = out.a[:, 0].copy()
        if k == until - 1:
            end = out.a[:, 0].copy()
        if 500 < k < until and k % 1000 == 0:
            P = core.estimator.P
            np.linalg.cholesky(P)
            assert np.array_equal(P, np.swapaxes(P, -1, -2))
            trace = max(trace, float(np.trace(P, axis1=-2, axis2=-1).max()))
    return stop, end, trace, out.a[:, 0]


@pytest.mark.parametrize('forgetting', ['variable_rate', 'directional'])
@pytest.mark.parametrize('noise', [0.0, 0.005])
@pytest.mark.parametrize(
    'silence',
    [pytest.param(60.0, id='minute'), pytest.param(3600.0, id='hour', marks=pytest.mark.long)],
)
def test_an_estimate_survives_silence_and_finds_a_changed_plant(forgetting, noise, silence):
    """Truth: a1 of the two plants. Silence moves a1 of each of 20 seeds by less than 0.02 and P not beyond its
    bound; two seconds of excitation bring a1 within 5 % of the changed plant, which is to be two deviations at least
    (a window that has seen nothing else is 2.1 % off).
    """
    stop, end, trace, after = life(forgetting, noise, silence, 20)
    assert np.abs(end - stop).max() < 0.02
    assert trace < 1e3
    assert np.sqrt(np.mean((after / CHANGED.a[0] - 1.0) ** 2)) < 0.025


@pytest.mark.parametrize('forgetting', ['variable_rate', 'directional'])
def test_noise_as_in_calibrate_does_not_gnaw_at_an_estimate(forgetting):
    """Truth: without the gate on the voltage, two minutes of noise move a1 by less than 0.02 (20 seeds). Where
    CALIBRATE is not asked for the noise, they move it by more: white noise says that a1 is 0.
    """
    stop, end, _, _ = life(forgetting, 0.005, 120.0, 20, input_hold=1e9)
    assert np.abs(end - stop).max() < 0.02
    stop, end, _, _ = life(forgetting, 0.005, 120.0, 20, input_hold=1e9, bias='none')
    assert np.abs(end - stop).max() > 0.05


def test_the_floor_is_the_quantile_of_noise():
    """Truth: |w|^2 / sigma^2 of two noisy outputs is chi-squared with 2 degrees of freedom, so one in a million exceeds
    2 ln 1e6 = 27.63; the deviation's upper limit from 400 samples is 1.121 times it (chi-squared tables: sqrt(399 /
    317.6)). Fewer than 20 samples tell nothing; a floor that is given stands.
    """
    rest = 0.1 * np.random.default_rng([45]).normal(size=400)
    for count, given, expected in (
        (400, 0.0, 1.121 * np.sqrt(27.63) * np.std(rest, ddof=1)),
        (19, 0.0, 0.0),
        (400, 0.2, 0.2),
    ):
        core = IdentifierCore(IdentifierParameters(forgetting='directional', regressor_floor=given))
        loud = expected * (1.0 + 2e-3) if expected else 1.0
        for k in range(count):
            core.step(k, Phase.CALIBRATE, rest[k], np.asarray(0.0))
        bias = np.mean(rest[:count])
        for k in range(count, count + 10):  # a regressor of one voltage, just below and just above
            u = loud if k > count + 5 else 0.99 * loud
            core.step(
                k, Phase.IDENTIFY, bias, np.asarray(u if k in {count + 2, count + 8} else 0.0)
            )
        # excited from the first voltage on: 8 samples, 2 of them with the voltage that is loud enough
        assert int(core.estimator.updates) == (2 if expected else 8)
        assert int(core.counters['regressors below the floor']) == (6 if expected else 0)


def test_directional_forgetting_is_its_equations(paper):
    """Truth: S, its eigenvectors above the floor and P in dense matrices, numpy (1e-9 relative); a record that excites
    everything, then one sine, then nothing, then everything again.
    """
    factor, floor, fade = 0.97, 0.002, 1.0 - 1.0 / 20.0
    generator = np.random.default_rng([46])
    u = generator.choice([-1.0, 1.0], size=400)
    u[100:200] = np.sin(0.3 * np.arange(100))
    u[200:300] = 0.0
    y = paper.simulate(u) + 0.0002 * generator.normal(size=400)
    e = RecursiveLeastSquares(5, (), DirectionalForgetting(factor, floor), 1e3, limit=1e9)
    R, S, theta, kinds = np.eye(5) / 1e3, np.zeros((5, 5)), np.zeros(5), set()
    for k in range(2, 400):
        w = np.array([-y[k - 1], -y[k - 2], u[k], u[k - 1], u[k - 2]])
        if np.linalg.norm(w) >= floor:
            S = fade * S + (1.0 - fade) * np.outer(w, w)
            values, vectors = np.linalg.eigh(S)
            V = vectors[:, values > max(floor**2, 1e-12 * np.trace(S))]
            kinds.add(V.shape[1])
            R = R - (1.0 - factor) * R @ V @ np.linalg.inv(V.T @ R @ V) @ V.T @ R
            R = R + np.outer(w, w)
            theta = theta + np.linalg.solve(R, w) * (y[k] - w @ theta)
        else:
            kinds.add(0)
        e.update(w, np.asarray(y[k]))
        np.testing.assert_allclose(e.P, np.linalg.inv(R), rtol=1e-7, atol=1e-9 * np.trace(e.P))
    np.testing.assert_allclose(e.theta, theta, rtol=1e-9)
    assert kinds >= {0, 4, 5}


def test_the_f_test_keeps_everything_while_nothing_changes():
    """Truth: with confidence 0.999 and independent normal errors, one sample in a thousand forgets; below 1 % here,
    because neighbouring windows share their samples.
    """
    rule = VariableRateForgetting(20, 100, 0.999)
    e = RecursiveLeastSquares(1, (500,), rule)
    generator = np.random.default_rng([42])
    active = np.ones(500, dtype=bool)
    forgot = [
        float(np.mean(rule.apply(e, None, generator.normal(size=500), active)[0] < 1.0))
        for _ in range(400)
    ]
    assert max(forgot[:119]) == 0.0
    assert np.mean(forgot[120:]) < 0.01


def test_the_f_statistic_is_the_ratio_of_the_two_windows():
    """Truth: numpy on the same errors, windows of 5 and 12, through several rounds of the ring (1e-12)."""
    rule = VariableRateForgetting(5, 12, 0.5, rate=1.0, smallest=1e-9)
    e = RecursiveLeastSquares(1, (), rule)
    errors = np.random.default_rng([43]).normal(size=80) * np.repeat([1.0, 4.0], 40)
    for k, error in enumerate(errors):
        factor, _, _ = rule.apply(e, None, np.asarray(error), np.asarray(True))
        if k < 16:
            assert float(factor) == 1.0
            continue
        recent, before = errors[k - 4 : k + 1], errors[k - 16 : k - 4]
        excess = np.sqrt(np.mean(recent**2) / np.mean(before**2)) - rule.threshold
        assert float(factor) == pytest.approx(1.0 / (1.0 + max(excess, 0.0)), rel=1e-12)


def test_a_sample_that_is_not_used_fills_no_window():
    """Truth: 200 unused samples leave the statistic where it was."""
    rule = VariableRateForgetting(2, 3, 0.5, smallest=1e-9)
    e = RecursiveLeastSquares(1, (), rule)
    for error in (1.0, 1.0, 1.0, 5.0, 5.0):
        factor, _, _ = rule.apply(e, None, np.asarray(error), np.asarray(True))
    for _ in range(200):
        again, _, _ = rule.apply(e, None, np.asarray(0.0), np.asarray(False))
    assert float(again) == float(factor) < 1.0


def test_covariance_resetting_follows_the_smallest_eigenvalue():
    """Truth: lambda_min of P by numpy; it never stays below the threshold, and the estimate is kept at the reset."""
    e = RecursiveLeastSquares(2, (), CovarianceResetting(0.05, 1.0), initial_covariance=1.0)
    generator = np.random.default_rng([44])
    lows = []
    for _ in range(200):
        w = generator.normal(size=2)
        e.update(w, np.asarray(w @ [1.0, -2.0]))
        lows.append(np.linalg.eigvalsh(e.P)[0])
    lows = np.array(lows)
    falls, resets = np.diff(lows) < 0.0, np.diff(lows) > 0.0
    assert resets.sum() >= 5
    assert (lows[:-1][resets] < 0.05).all()
    assert (lows[:-1][falls] >= 0.05).all()
    np.testing.assert_allclose(e.theta, [1.0, -2.0], atol=1e-3)


def test_covariance_resetting_waits_for_the_data_whatever_the_start():
    """Truth: lambda_min(P) = 1 / lambda_max(R) with R = sum w w^T + 1e-18, numpy; from P(0) = 1e18 every
    reset comes with the sample after R has exceeded 1 / threshold, not before (P itself would be lost in rounding).
    """
    e = RecursiveLeastSquares(3, (), CovarianceResetting(1e-2, 1.0))
    generator = np.random.default_rng([47])
    R, resets = 1e-18 * np.eye(3), 0
    for _ in range(800):
        due = np.linalg.eigvalsh(R)[-1] > 1e2
        w = generator.normal(size=3) * [1.0, 0.1, 10.0 ** generator.integers(-3, 1)]
        R = (np.eye(3) if due else R) + np.outer(w, w)
        e.update(w, np.asarray(w @ [1.0, -2.0, 0.5]))
        inverse = np.linalg.inv(e.U)
        found = inverse.T @ np.diag(1.0 / e.d) @ inverse
        np.testing.assert_allclose(found, R, atol=1e-9 * np.trace(R))
        resets += due
    assert resets > 3


def test_a_dead_zone_leaves_small_errors_out():
    """Truth: |e| = 0.2 in a zone of 0.3 changes nothing; 0.4 does."""
    e = RecursiveLeastSquares(1, (), DeadZone(0.3))
    e.update(np.ones(1), np.asarray(0.2))
    assert float(e.theta[0]) == 0.0
    assert float(e.updates) == 0.0
    e.update(np.ones(1), np.asarray(0.4))
    assert float(e.theta[0]) == pytest.approx(0.4)
