# SPDX-FileCopyrightText: 2026 The satvib authors
# SPDX-License-Identifier: Apache-2.0
"""The measures behind the verdict on a model."""

import numpy as np
import pytest
from satvib_common.errors import SatvibError
from satvib_ident.excitation import make_excitation
from satvib_ident.models.iir_model import IirModel
from satvib_ident.trust.measures import RecentSignal
from satvib_ident.trust.model_error import ModelError
from satvib_ident.trust.response_deviation import ResponseDeviation
from scipy.stats import chi2


def recent(values, window=200, shape=()):
    signal = RecentSignal(window, shape)
    for value in np.moveaxis(np.asarray(values, dtype=float), -1, 0):
        signal.push(value, np.ones(shape, dtype=bool))
    return signal


@pytest.mark.parametrize(
    ('name', 'options', 'order'),
    [
        ('sines', {}, 4),
        ('sines', {'frequencies': [1.0, 2.0, 5.0]}, 6),
        ('squares', {}, 12),
        ('prbs', {}, 12),
        ('multisine', {}, 12),
    ],
)
def test_the_order_of_persistent_excitation(name, options, order):
    """Truth: F sines excite order 2 F; broad-band signals more than the 12 that are looked for."""
    u = make_excitation(name, amplitude=5.0, dt=0.01, **options).samples(400)
    assert float(recent(u).excitation_order(12)) == order


def test_the_order_of_silence_of_a_constant_and_of_few_samples():
    """Truth: 0 for nothing, 1 for a constant; never more than half the samples held."""
    assert float(recent(np.zeros(300)).excitation_order(12)) == 0
    assert float(recent(np.full(300, 3.0)).excitation_order(12)) == 1
    noise = np.random.default_rng([61]).normal(size=10)
    assert float(recent(noise).excitation_order(12)) == 5
    assert float(RecentSignal(50).excitation_order(12)) == 0


def test_the_order_is_that_of_the_window_and_not_of_the_past():
    """Truth: noise, then 200 samples of a constant in a window of 200: order 1 again."""
    noise = np.random.default_rng([62]).normal(size=250)
    assert float(recent(np.append(noise, np.ones(200))).excitation_order(12)) == 1


def test_whiteness_is_the_ljung_box_statistic():
    """Truth: the formula by numpy on the window alone (1e-12)."""
    e = np.random.default_rng([63]).normal(size=330)
    x = e[-200:]
    r = np.array([np.sum(x[j:] * x[: 200 - j]) for j in range(11)]) / np.sum(x * x)
    q = 200 * 202 * np.sum(r[1:] ** 2 / (200 - np.arange(1, 11)))
    assert float(recent(e).whiteness(10)) == pytest.approx(q / 10, rel=1e-12)


def test_whiteness_of_white_and_of_coloured_residuals():
    """Truth: Q is chi-squared with 10 degrees of freedom: 95 % of 1000 white records below its 95 % point (4 sigma
    of that count: 2.8 %); a first-order noise with 0.5 is found out in every record.
    """
    e = np.random.default_rng([64]).normal(size=(1000, 200))
    below = np.mean(recent(e, shape=(1000,)).whiteness(10) * 10 < chi2.ppf(0.95, 10))
    assert below == pytest.approx(0.95, abs=0.028)
    coloured = e.copy()
    for k in range(1, 200):
        coloured[:, k] += 0.5 * coloured[:, k - 1]
    assert (recent(coloured, shape=(1000,)).whiteness(10) * 10 > chi2.ppf(0.95, 10)).all()


def test_whiteness_is_not_known_without_samples_or_power():
    """Truth: fewer than 3 lags of samples, or no residual at all: NaN."""
    assert np.isnan(recent(np.ones(20)).whiteness(10))
    assert np.isnan(recent(np.zeros(200)).whiteness(10))


def test_response_deviation_is_the_spread_of_the_response(paper):
    """Truth: 4000 models drawn from the covariance, RMS of |G - G0| / |G0| at the worst frequency; 4 sigma is 5 %."""
    root = 1e-3 * np.random.default_rng([65]).normal(size=(5, 5))
    covariance = root @ root.T
    measure = ResponseDeviation((5.0, 20.0), 0.01, 2, 3)
    draws = paper.theta + np.random.default_rng([66]).normal(size=(4000, 5)) @ root.T
    models = IirModel(draws[:, :2], draws[:, 2:], 0, 0.01)
    g0 = paper.frequency_response(measure.frequencies)
    spread = np.sqrt(
        np.mean(np.abs(models.frequency_response(measure.frequencies) / g0 - 1) ** 2, 0)
    )
    assert float(measure(paper.theta, covariance)) == pytest.approx(spread.max(), rel=0.05)


@pytest.mark.parametrize('band', [(0.0, 10.0), (20.0, 10.0), (5.0, 50.0)])
def test_a_band_that_makes_no_sense_is_refused(band):
    """Truth: 0 < low <= high < 50 Hz at 100 Hz is broken in each."""
    with pytest.raises(SatvibError, match='trust_band'):
        ResponseDeviation(band, 0.01, 2, 3)


@pytest.fixture
def seen():
    """What the residual gives away: seen(plant, model, noise) -> measured, and the true relative error."""

    def measure(plant, model, noise, name='prbs'):
        u = make_excitation(name, amplitude=1.0, dt=0.01).samples(400)
        y = plant.simulate(u) + noise * np.random.default_rng([67]).normal(size=400)
        f = np.geomspace(5.0, 20.0, 8)
        error = ModelError(f, 0.01, model.order, model.b.size, 200)
        for k in range(400):
            error.push(y[k], u[k], np.asarray(True))
        true = np.abs(plant.frequency_response(f) / model.frequency_response(f) - 1).max()
        return float(error(model.theta)), float(true)

    return measure


@pytest.mark.parametrize('scale', [1.0, 1.2, 2.0, 0.5])
@pytest.mark.parametrize('name', ['prbs', 'multisine'])
def test_a_wrong_gain_is_seen(seen, paper, scale, name):
    """Truth: |1/scale - 1|, the relative error of the response of a model scaled by that; 0.05 + 10 % of it."""
    model = IirModel(paper.a, scale * paper.b, 0, 0.01)
    measured, true = seen(paper, model, 0.0005, name)
    assert true == pytest.approx(abs(1 / scale - 1), abs=1e-12)
    assert measured == pytest.approx(true, abs=0.05 + 0.1 * true)


def test_a_wrong_delay_and_a_low_order_are_seen(seen, paper):
    """Truth: the true relative error in the band is above 0.4 for both; so is the measure."""
    late = IirModel(paper.a, np.append(0.0, paper.b)[:3], 0, 0.01)
    for model in (late, IirModel([-0.3], [0.061, -0.08], 0, 0.01)):
        measured, true = seen(paper, model, 0.0005)
        assert true > 0.4
        assert measured > 0.4


def test_a_band_without_input_hides_any_error(paper):
    """Truth: by construction: five sines up to 5 Hz say nothing of 10 to 20 Hz once there is noise (infinity), a PRBS
    does, and without noise five sines say everything that five parameters need.
    """
    f = np.geomspace(10.0, 20.0, 4)
    for name, noise, hidden in (
        ('sines', 0.005, True),
        ('prbs', 0.005, False),
        ('sines', 0.0, False),
    ):
        options = {'frequencies': [1.0, 2.0, 3.0, 4.0, 5.0]} if name == 'sines' else {}
        u = make_excitation(name, amplitude=1.0, dt=0.01, **options).samples(200)
        y = paper.simulate(u) + noise * np.random.default_rng([68]).normal(size=200)
        error = ModelError(f, 0.01, 2, 3, 200)
        for k in range(200):
            error.push(y[k], u[k], np.asarray(True))
        assert np.isinf(error(paper.theta)) == hidden


def test_the_deviation_of_the_filter_is_that_of_ridge_regression(paper):
    """Truth: s^2 c (R + ridge)^-1 c* in dense matrices; the noise at which it reaches half of |B|^2 parts finite from
    infinite (0.1 %, where s^2 scales as the square of a residual that is all noise).
    """
    f, lags = 15.0, 20
    u = make_excitation('squares', amplitude=1.0, dt=0.01, frequencies=[1.0, 2.0]).samples(200)
    white = np.random.default_rng([69]).normal(size=200)
    A = np.concatenate(([1.0], paper.a))
    U = np.array([u[k - np.arange(lags)] for k in range(lags - 1, 200)])
    e = np.convolve(white, A)[lags - 1 : 200]
    R = U.T @ U
    ridge = R + 1e-3 * R[0, 0] * np.eye(lags)
    left = e @ e - (U.T @ e) @ np.linalg.solve(ridge, U.T @ e)
    c = np.exp(-2j * np.pi * 0.01 * f * np.arange(lags))
    spread = left / len(e) * np.real(c @ np.linalg.solve(ridge, c.conj()))
    B = paper.b @ np.exp(-2j * np.pi * 0.01 * f * np.arange(3))
    edge = np.sqrt(0.5 * np.abs(B) ** 2 / spread)
    for noise, hidden in ((0.999 * edge, False), (1.001 * edge, True)):
        error = ModelError(np.array([f]), 0.01, 2, 3, 200)
        for y, drive in zip(paper.simulate(u) + noise * white, u, strict=True):
            error.push(y, drive, np.asarray(True))
        assert np.isinf(error(paper.theta)) == hidden


def test_too_few_samples_tell_nothing(paper):
    """Truth: with 20 lags at least 79 samples are needed; NaN before."""
    error = ModelError(np.array([10.0]), 0.01, 2, 3, 200)
    known = []
    for k in range(100):
        error.push(np.asarray(np.cos(k * k)), np.asarray(np.sin(3 * k * k)), np.asarray(True))
        known.append(not np.isnan(error(paper.theta)))
    assert known.index(True) == 78
