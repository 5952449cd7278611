# SPDX-FileCopyrightText: 2026 The satvib authors
# SPDX-License-Identifier: Apache-2.0
"""Frequency responses by the local polynomial method: one transform of the whole record, for sweeps and transients.

Around each line k the response, and what the ends of the record leave behind (leakage), are smooth. So

    Y(k + r) = (H + h_1 r + h_2 r^2) X(k + r) + t_0 + t_1 r + t_2 r^2 + noise

is solved over the lines k + r by least squares, r from -n to n. H is the response at k, without the bias of averaging
over a resonance and without leakage. What is left of the 2 n + 1 lines beyond the unknowns gives the variance of the
noise, and with it the disc.

A sweep at the beginning or the end of a record looks like leakage. A record that holds a whole transient, from rest to
rest, has none, and is estimated without the t.

R. Pintelon, J. Schoukens, G. Vandersteen and K. Barbe, Mechanical Systems and Signal Processing 24, 2010.
"""

import numpy as np
from satvib_common.arrays import Array, Complex
from satvib_common.errors import SatvibError

from satvib_ident.frequency.confidence import disc_factor
from satvib_ident.frequency.response import FrequencyResponse

HALF = 6  # n, lines on either side
ORDER = 2


def local_response(
    x: Array,
    y: Array,
    dt: float,
    confidence: float = 0.95,
    half: int = HALF,
    rest: bool = False,
) -> FrequencyResponse:
    """Estimate from a whole record.

    Args:
        x: (..., t) input.
        y: (..., t) output.
        dt: s.
        confidence: of the disc.
        half: lines on either side of each line that is estimated; one of `half` lines is.
        rest: the record begins and ends at rest, so there is no leakage.

    Raises:
        SatvibError: a gap in the record, or one that is too short.
    """
    x, y = np.broadcast_arrays(x, y)
    if not (np.isfinite(x).all() and np.isfinite(y).all()):
        raise SatvibError('samples are missing; a sweep is estimated as a whole, and has no gap')
    unknown = (1 if rest else 2) * (ORDER + 1)
    width = 2 * half + 1
    lines_x, lines_y = (_lines(signal) for signal in (x, y))
    centres = np.arange(half, lines_x.shape[-1] - half, half)
    if width <= unknown or not centres.size:
        raise SatvibError(f'{x.shape[-1]} samples are too few for an estimate of {width} lines')
    around = np.arange(-half, half + 1) / half
    powers = around[:, None] ** np.arange(ORDER + 1)
    near_x = lines_x[..., centres[:, None] + np.arange(-half, half + 1)]  # (..., f, r)
    near_y = lines_y[..., centres[:, None] + np.arange(-half, half + 1)]
    size = np.sqrt(np.mean(np.abs(near_x) ** 2, axis=-1, keepdims=True))
    size = np.where(size > 0.0, size, 1.0)
    basis = (near_x / size)[..., None] * powers
    if not rest:
        leakage = np.broadcast_to(powers, basis.shape)
        basis = np.concatenate([basis, leakage], axis=-1)
    inverse = np.linalg.pinv(basis)  # (..., f, unknown, r)
    fitted = np.einsum('...ur,...r->...u', inverse, near_y)
    left = near_y - np.einsum('...ru,...u->...r', basis, fitted)
    free = width - unknown
    noise = np.sum(np.abs(left) ** 2, axis=-1) / free
    spread = np.sum(np.abs(inverse[..., 0, :]) ** 2, axis=-1)
    with np.errstate(divide='ignore', invalid='ignore'):
        coherence = 1.0 - noise / np.mean(np.abs(near_y) ** 2, axis=-1)
    radius = np.sqrt(disc_factor(free, confidence) * noise * spread) / size[..., 0]
    return FrequencyResponse(
        (centres + 1) / (x.shape[-1] * dt), fitted[..., 0] / size[..., 0],
        np.clip(coherence, 0.0, 1.0), radius, float(free), confidence,
        f'local polynomials over {width} lines of {1.0 / (x.shape[-1] * dt):.2g} Hz',
    )  # fmt: skip


def _lines(signal: Array) -> Complex:
    """The transform (..., f) without 0 and half the sample rate; the mean value is taken off."""
    count = signal.shape[-1]
    around = signal - signal.mean(axis=-1, keepdims=True)
    return np.asarray(np.fft.rfft(around, axis=-1)[..., 1 : (count + 1) // 2])
