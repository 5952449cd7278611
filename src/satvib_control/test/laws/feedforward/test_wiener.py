# SPDX-FileCopyrightText: 2026 The satvib authors
# SPDX-License-Identifier: Apache-2.0
"""The yardsticks of feedforward, against closed forms."""

import math

import numpy as np
import pytest
from satvib_common.errors import SatvibError
from satvib_control.laws.feedforward.wiener import (
    coherence_bound,
    uncontrolled,
    wiener_from_spectra,
    wiener_optimum,
)
from satvib_ident.models.iir_model import IirModel
from scipy.signal import lfilter

DELAY = IirModel([], [0.5], 1, 0.005)  # G = 0.5 z^-1


def test_a_path_slower_than_the_disturbance_leaves_what_cannot_be_predicted():
    """x is AR(1) with coefficient 0.9 and reaches y at once; the voltage acts one sample later.

    Truth, closed form: the one-step prediction error has the variance 1 - 0.9^2 of the signal, -7.21 dB, with
    w = -0.9 / 0.5. Three standard deviations of least squares,
    sqrt(1.81 / 50000) / 0.5 = 0.012 each; 0.01 dB against the innovations that the record was made of.
    """
    white = np.random.default_rng(1).standard_normal(100_000)
    x = lfilter([1.0], [1.0, -0.9], white)
    found = wiener_optimum(x, x, DELAY, taps=4, motion=False)
    wanted = 10 * math.log10(white[50_004:].var() / x[50_004:].var())
    assert found.attenuation == pytest.approx(wanted, abs=0.01)
    assert wanted == pytest.approx(10 * math.log10(1 - 0.81), abs=0.3)
    np.testing.assert_allclose(found.weights, [-1.8, 0.0, 0.0, 0.0], atol=0.036)
    assert found.voltage_rms == pytest.approx(1.8 * x.std(), rel=0.03)


def test_white_noise_that_comes_late_is_cancelled_and_early_is_not():
    """Truth, closed form: d = x(k - 3) is reached by w_2 = -1 / 0.5; d = x(k) not at all (0 dB to 0.02 dB)."""
    x = np.random.default_rng(2).standard_normal(20_000)
    late = np.concatenate([np.zeros(3), x[:-3]])
    found = wiener_optimum(x, late, DELAY, taps=4, motion=False)
    np.testing.assert_allclose(found.weights, [0.0, 0.0, -2.0, 0.0], atol=1e-9)
    assert found.attenuation < -150.0
    assert wiener_optimum(x, x, DELAY, taps=4, motion=False).attenuation == pytest.approx(
        0, abs=0.02
    )


def test_records_and_spectra_agree():
    """Truth: the same optimum by another road, from exact spectra of AR(1) through G. 1e-6 of the weights, 1e-6 dB.

    And with the leak of 0.1: closed form for one tap, w = -r / (R (1 + q)).
    """
    z = np.exp(-2j * np.pi * np.arange(4096) / 4096)
    sxx = 1.0 / np.abs(1.0 - 0.9 * z) ** 2
    weights, attenuation = wiener_from_spectra(sxx, sxx, sxx, 0.5 * z, 4)
    np.testing.assert_allclose(weights, [-1.8, 0, 0, 0], atol=1e-6)
    assert attenuation == pytest.approx(10 * math.log10(0.19), abs=1e-6)
    leaked = wiener_from_spectra(sxx, sxx, sxx, 0.5 * z, 1, leak=0.1)[0]
    assert leaked[0] == pytest.approx(-1.8 / 1.1, rel=1e-6)


def test_a_double_integrator_is_what_velocity_and_displacement_are_for():
    """The payload needs u = -(K s + C v) of the lower plate; the path is quick, the band 2 to 20 Hz.

    Truth: with both in the regressor two taps do what 60 taps alone do not, by 10 dB.
    """
    from satvib_common.signals.integrator import leaky_integrator

    rng = np.random.default_rng(3)
    x = lfilter(*_band(2.0, 20.0), rng.standard_normal(20_000))
    v = lfilter(*leaky_integrator(0.05, 0.005), x)
    s = lfilter(*leaky_integrator(0.05, 0.005), v)
    d = np.concatenate([np.zeros(2), (4000.0 * s + 40.0 * v)[:-2]])
    short = wiener_optimum(x, d, DELAY, taps=2, motion=True, corner=0.05)
    long = wiener_optimum(x, d, DELAY, taps=60, motion=False)
    assert short.attenuation < long.attenuation - 10.0


def _band(low, high):
    from scipy.signal import butter

    return butter(2, [low, high], 'band', fs=200.0)


def test_the_coherence_bound_is_the_signal_to_noise_ratio():
    """Truth, closed form: d = x + n with white n of 1 / 9 of the power: coherence 0.9, bound -10 dB. 0.2 dB, 0.01."""
    x, n = np.random.default_rng(4).standard_normal((2, 200_000))
    bound = coherence_bound(x, x + n / 3.0, 200.0, block=512)
    assert bound.total == pytest.approx(-10.0, abs=0.2)
    assert np.median(bound.coherence) == pytest.approx(0.9, abs=0.01)
    assert bound.attenuation.mean() == pytest.approx(-10.0, abs=0.3)


def test_the_uncontrolled_vibration_is_found_again():
    """Truth: d that the record was made of. 1e-12."""
    d, u = np.random.default_rng(5).standard_normal((2, 300))
    model = IirModel([-0.7, 0.2], [0.3, -0.1], 2, 0.005)
    y = d + lfilter([0, 0, 0.3, -0.1], [1.0, -0.7, 0.2], u)
    np.testing.assert_allclose(uncontrolled(y, u, model), d, atol=1e-12)


def test_records_that_will_not_do_are_refused():
    """Truth: the message names what is wrong."""
    x = np.ones(50)
    with pytest.raises(SatvibError, match='50 samples are too few for 18 weights'):
        wiener_optimum(x, x, DELAY)
    with pytest.raises(SatvibError, match='less than four blocks'):
        coherence_bound(x, x, 200.0)
    holed = np.ones(5000)
    holed[7] = np.nan
    with pytest.raises(SatvibError, match='sample 7 is not finite'):
        wiener_optimum(holed, np.ones(5000), DELAY)
