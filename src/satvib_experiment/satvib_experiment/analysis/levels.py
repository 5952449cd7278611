# SPDX-FileCopyrightText: 2026 The satvib authors
# SPDX-License-Identifier: Apache-2.0
"""Levels of a vibration: amplitude of tones, running RMS, spectrum. The ratio in dB is `satvib_common.levels.decibel`.

    attenuation = 20 log10(x1 / x2)                                              (42)

with x1 the level under control and x2 the level without: negative is better. A mean value is taken off first; in an
accelerometer it is bias, not vibration.
"""

from collections.abc import Sequence

import numpy as np
from satvib_common.arrays import Array


def tone_amplitudes(signal: Array, dt: float, frequencies: Sequence[float]) -> Array:
    """Amplitudes of tones of known frequency, by least squares over all of them and a constant at once.

    Args:
        signal: (samples, ...).
        dt: s, spacing of the samples.
        frequencies: Hz; each below half the sample rate.

    Returns:
        (tones, ...) amplitudes. Rows that hold a NaN are left out; with too few rows left the result is NaN.
    """
    flat = signal.reshape(len(signal), -1)
    good = np.all(np.isfinite(flat), axis=1)
    angle = 2.0 * np.pi * np.outer(np.arange(len(signal)) * dt, frequencies)
    basis = np.column_stack([np.cos(angle), np.sin(angle), np.ones(len(signal))])[good]
    shape = (len(frequencies), *signal.shape[1:])
    if len(basis) <= basis.shape[1]:
        return np.full(shape, np.nan)
    weights = np.linalg.lstsq(basis, flat[good], rcond=None)[0]
    n = len(frequencies)
    return np.hypot(weights[:n], weights[n : 2 * n]).reshape(shape)


def tone_level(signal: Array, dt: float, frequencies: Sequence[float]) -> Array:
    """Amplitude of all tones together, the root of the sum of squares; NaN without tones."""
    if not len(frequencies):
        return np.full(signal.shape[1:], np.nan)
    return np.asarray(np.sqrt(np.sum(tone_amplitudes(signal, dt, frequencies) ** 2, axis=0)))


def tone_floor(noise: float, samples: int, tones: int) -> float:
    """Level that `tone_level` finds in nothing but white noise.

    The amplitude fitted to white noise of deviation s over N samples has the mean square 4 s^2 / N per tone.

    Args:
        noise: RMS of the noise.
        samples: N.
        tones: number of tones fitted.
    """
    return float(noise * np.sqrt(4.0 * tones / samples)) if samples and tones else float('nan')


def moving_rms(signal: Array, window: int) -> Array:
    """RMS over the `window` samples up to each one; (samples, ...) alike, fewer at the start."""
    window = max(min(window, len(signal)), 1)
    squares = np.cumsum(np.where(np.isfinite(signal), signal, 0.0) ** 2, axis=0)
    total = squares.copy()
    total[window:] -= squares[:-window]
    count = np.minimum(np.arange(1, len(signal) + 1), window)
    result: Array = np.sqrt(np.maximum(total, 0.0) / count.reshape(-1, *([1] * (signal.ndim - 1))))
    return result


def spectrum(signal: Array, dt: float, resolution: float = 1.0) -> tuple[Array, Array]:
    """Amplitude spectral density by Welch's method (Hann, half overlap, mean taken off).

    Args:
        signal: (samples, ...).
        dt: s.
        resolution: Hz, spacing of the lines; coarser when the signal is shorter than that.

    Returns:
        Frequencies (lines,) in Hz, and the density (lines, ...) in the unit of the signal per root Hz.
    """
    # who asks for a spectrum draws it; to import scipy.signal for it takes longer than all figures
    from matplotlib import mlab

    length = min(len(signal), round(1.0 / (resolution * dt)))
    flat = np.nan_to_num(signal).reshape(len(signal), -1)
    window = np.hanning(length + 1)[:-1]
    found = [
        mlab.psd(column, length, 1.0 / dt, mlab.detrend_mean, window, length // 2)
        for column in flat.T
    ]
    power: Array = np.stack([power for power, _ in found], axis=-1)
    return np.asarray(found[0][1]), np.sqrt(power).reshape(-1, *signal.shape[1:])
