# SPDX-FileCopyrightText: 2026 The satvib authors
# SPDX-License-Identifier: Apache-2.0
"""Auto- and cross-spectra of signals by averaging over windowed segments that overlap (Welch's method).

The transforms are those of `scipy.signal.ShortTimeFFT`. A segment with a sample that is missing (NaN) in any of the
channels is left out. Overlapping segments are not independent: K of them count as

    n = K / (1 + 2 sum_k (1 - k / K) rho_k),    rho_k = (sum_i w_i w_{i + k hop})^2 / (sum_i w_i^2)^2

P. D. Welch, IEEE Transactions on Audio and Electroacoustics 15, 1967; J. S. Bendat and A. G. Piersol, Random Data, 4th
edition, 2010, section 11.5.
"""

from dataclasses import dataclass

import numpy as np
from satvib_common.arrays import Array, Complex
from satvib_common.errors import SatvibError

from satvib_ident.frequency.settings import FrfSettings


@dataclass(frozen=True, eq=False)
class Spectra:
    """Averaged spectra of c channels.

    Attributes:
        frequency: (f,) Hz, without 0.
        matrix: (..., f, c, c) mean of X_i conj(X_j), one-sided, unit^2 / Hz.
        averages: (...) independent averages.
        segments: (...) segments averaged over.
    """

    frequency: Array
    matrix: Complex
    averages: Array
    segments: Array


def effective_averages(window: Array, hop: int, segments: Array) -> Array:
    """Give how many independent averages some segments (...) with overlap are worth, (...)."""
    power = float(np.sum(window * window))
    count = np.asarray(segments, dtype=float)
    total = np.ones_like(count)
    for k in range(1, -(-len(window) // hop)):
        shared = float(np.sum(window[: -k * hop] * window[k * hop :])) / power
        with np.errstate(divide='ignore', invalid='ignore'):
            total += np.where(count > k, 2.0 * (1.0 - k / count) * shared * shared, 0.0)
    return np.asarray(count / total)


def averaged_spectra(signals: Array, dt: float, settings: FrfSettings) -> Spectra:
    """Average over a record.

    Args:
        signals: (..., c, t); NaN where a sample is missing.
        dt: s.
        settings: window, overlap, resolution or averages.

    Raises:
        SatvibError: the record is too short, or has a gap in all of its segments but one.
    """
    from scipy.signal import ShortTimeFFT, get_window  # slow to import

    length = settings.segment(signals.shape[-1], dt)
    hop = settings.hop(length)
    window = get_window(settings.window, length)
    transform = ShortTimeFFT(
        window, hop, 1.0 / dt, fft_mode='onesided2X', scale_to='psd', phase_shift=None
    )
    # the first segment begins with the record, so nothing is added at its ends
    count = (signals.shape[-1] - length) // hop + 1
    segments = transform.stft_detrend(
        signals, 'constant', p0=0, p1=count, k_offset=transform.m_num_mid
    )
    whole = np.isfinite(segments).all(axis=(-3, -2))  # (..., k)
    whole_count = whole.sum(axis=-1)
    if np.any(whole_count < 2):
        raise SatvibError(
            f'fewer than two segments of {length * dt:.3g} s are without a gap; take a coarser resolution'
        )
    known = np.where(whole[..., None, None, :], segments, 0.0)[..., 1:, :]
    total = np.einsum('...ifk,...jfk->...fij', known, known.conj())
    matrix = total / whole_count[..., None, None, None]
    return Spectra(
        transform.f[1:], matrix, effective_averages(window, hop, whole_count), whole_count
    )
