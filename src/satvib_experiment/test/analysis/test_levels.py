# SPDX-FileCopyrightText: 2026 The satvib authors
# SPDX-License-Identifier: Apache-2.0
"""Levels, tones and spectra against closed forms."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from satvib_experiment.analysis.levels import (
    moving_rms,
    spectrum,
    tone_amplitudes,
    tone_floor,
    tone_level,
)

DT = 0.01
T = np.arange(1000) * DT


@given(st.floats(0.5, 49.0), st.floats(1e-6, 1e3), st.floats(0, 6.3), st.floats(-50, 50))
def test_the_amplitude_of_a_tone_is_found_exactly(f, amplitude, phase, offset):
    """Closed form: a sine of any frequency below Nyquist, also not periodic in the window; 1e-7 of the larger part."""
    signal = amplitude * np.sin(2 * np.pi * f * T + phase) + offset
    found = tone_amplitudes(signal, DT, [f])[0]
    assert found == pytest.approx(amplitude, abs=1e-7 * max(amplitude, abs(offset), 1e-6))


def test_several_tones_do_not_disturb_each_other():
    """Closed form: amplitudes 1, 0.1 and 0.01, half a hertz apart, with samples missing; 1e-9."""
    signal = sum(a * np.sin(2 * np.pi * f * T + a) for a, f in ((1, 10.0), (0.1, 10.5), (0.01, 11)))
    signal[100:130] = np.nan
    frequencies = [10.0, 10.5, 11.0]
    np.testing.assert_allclose(
        tone_amplitudes(signal, DT, frequencies), [1.0, 0.1, 0.01], rtol=1e-9
    )
    assert tone_level(signal, DT, frequencies) == pytest.approx(np.sqrt(1.0101), rel=1e-9)


def test_without_tones_or_samples_nothing_is_claimed():
    """Truth: there is nothing to fit."""
    assert np.all(np.isnan(tone_level(np.ones((10, 3)), DT, [])))
    assert np.isnan(tone_amplitudes(np.full(50, np.nan), DT, [5.0])[0])


def test_the_floor_of_a_tone_is_what_white_noise_gives():
    """Truth: 4000 draws of white noise; the mean square of the fitted amplitude within 5 % (3 sigma is 4.7 %)."""
    noise = np.random.default_rng([1, 99]).standard_normal((500, 4000)) * 0.3
    found = tone_amplitudes(noise, DT, [10.0])[0]
    assert np.sqrt(np.mean(found**2)) == pytest.approx(tone_floor(0.3, 500, 1), rel=0.05)


def test_moving_rms_against_a_plain_loop():
    """Truth: the definition, written as a loop; rounding only."""
    signal = np.random.default_rng([2, 99]).standard_normal((60, 2))
    plain = [np.sqrt(np.mean(signal[max(0, k - 6) : k + 1] ** 2, axis=0)) for k in range(60)]
    np.testing.assert_allclose(moving_rms(signal, 7), plain, rtol=1e-12)


def test_the_spectrum_of_white_noise_is_flat_and_adds_up():
    """Closed form: density sigma sqrt(2 dt); its square integrates to the variance. Averaged over 200 windows, 3 %."""
    noise = np.random.default_rng([3, 99]).standard_normal(100 * 200)
    f, density = spectrum(noise, DT)
    assert f[1] == pytest.approx(1.0)
    power = np.sum(density[1:] ** 2) * (f[1] - f[0])
    assert power == pytest.approx(1.0, rel=0.03)
    assert np.mean(density[2:-2]) == pytest.approx(np.sqrt(2 * DT), rel=0.03)
