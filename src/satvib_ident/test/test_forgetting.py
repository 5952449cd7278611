# SPDX-FileCopyrightText: 2026 The satvib authors
# SPDX-License-Identifier: Apache-2.0
"""What the rules for old data do when the plant changes, and when the excitation stops."""

import numpy as np
import pytest
from satvib_common.phases import Phase
from satvib_ident.excitation import make_excitation
from satvib_ident.forgetting import CovarianceResetting, DeadZone, VariableRateForgetting
from satvib_ident.identifier import IdentifierCore
from satvib_ident.iir_model import IirModel
from satvib_ident.parameters import IdentifierParameters
from satvib_ident.recursive_least_squares import RecursiveLeastSquares

PLANT = IirModel([-0.460, 0.158], [0.061, -0.103, 0.033], 1, 0.01)
CHANGED = IirModel([-0.70, 0.25], [0.05, -0.09, 0.03], 1, 0.01)


def life(forgetting, noise, silence, seeds):
    """Excite for 4 s, fall silent, change the plant, excite for 2 s; PRBS of 5 V, noise on the output.

    Returns: a1 at the stop and at the end of the silence, the largest trace of P in the silence, a1 after the change.
    """
    parameters = IdentifierParameters(
        forgetting=forgetting, forgetting_factor=0.99, bias='none', measure_period=10**9
    )
    core = IdentifierCore(parameters, (seeds,))
    signal = make_excitation('prbs', amplitude=5.0, dt=0.01)
    generator = np.random.default_rng([41])
    quiet = round(silence * 100)
    u = np.concatenate([signal.samples(400), np.zeros(quiet), signal.samples(900)[700:]])
    y = np.concatenate([PLANT.simulate(u[: 400 + quiet]), CHANGED.simulate(u[400 + quiet :])])
    trace, stop, end = 0.0, None, None
    for k in range(len(u)):
        out = core.step(
            k,
            Phase.IDENTIFY,
            y[k] + noise * generator.normal(size=seeds),
            np.full(seeds, u[k - 1] if k else 0.0),
        )
        if k == 400:
            stop = out.a[:, 0].copy()
        if k == 400 + quiet - 1:
            end = out.a[:, 0].copy()
        if 400 < k < 400 + quiet and k % 1000 == 0:
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
    """Truth: a1 of the two plants. Silence moves a1 by less than 0.02 and P not beyond its bound; two seconds of
    excitation bring a1 within 5 % of the changed plant, for each of 4 seeds.
    """
    stop, end, trace, after = life(forgetting, noise, silence, 4)
    assert np.abs(end - stop).max() < 0.02
    assert trace < 1e6
    assert np.abs(after / CHANGED.a[0] - 1.0).max() < 0.05


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


def test_a_dead_zone_leaves_small_errors_out():
    """Truth: |e| = 0.2 in a zone of 0.3 changes nothing; 0.4 does."""
    e = RecursiveLeastSquares(1, (), DeadZone(0.3))
    e.update(np.ones(1), np.asarray(0.2))
    assert float(e.theta[0]) == 0.0
    assert float(e.updates) == 0.0
    e.update(np.ones(1), np.asarray(0.4))
    assert float(e.theta[0]) == pytest.approx(0.4)
