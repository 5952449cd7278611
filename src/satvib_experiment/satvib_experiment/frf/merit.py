# SPDX-FileCopyrightText: 2026 The satvib authors
# SPDX-License-Identifier: Apache-2.0
"""What an isolator is judged by, from a measured transmissibility: peak, where isolation begins, roll-off."""

import math
from dataclasses import dataclass

import numpy as np
from satvib_common.arrays import Array, Mask
from satvib_ident.frequency.response import FrequencyResponse

TRUSTED = 0.5  # coherence below which a line says nothing
BEYOND = 2.0  # times the frequency at which isolation begins: there the roll-off begins
LEAST = 8  # lines for a roll-off
_FLOOR = 0.02  # of the magnitude: no line counts more than if it were known to this


@dataclass(frozen=True)
class Merit:
    """Figures of one transmissibility; None where the band does not show it.

    Attributes:
        peak: dB, the largest value.
        peak_frequency: Hz.
        isolation_from: Hz, above it the payload moves less than the base up to the end of the band.
        roll_off: dB per decade, negative; fitted from `roll_off_from` to `roll_off_to`, Hz.
        coherence: median over the lines.
    """

    peak: float
    peak_frequency: float
    isolation_from: float | None
    roll_off: float | None
    roll_off_from: float | None
    roll_off_to: float | None
    coherence: float


def merit_of(measured: FrequencyResponse) -> Merit | None:
    """Give the figures of a response (f,); None without a line of coherence 0.5."""
    f, size = measured.frequency, measured.decibels
    trusted = _trusted(measured)
    if not trusted.any():
        return None
    peak = int(np.flatnonzero(trusted)[np.argmax(size[trusted])])
    begins = _isolation(f, size, trusted)
    slope = roll_off(measured, BEYOND * begins) if begins is not None else None
    return Merit(
        peak=float(size[peak]),
        peak_frequency=float(f[peak]),
        isolation_from=begins,
        roll_off=slope[0] if slope else None,
        roll_off_from=slope[1] if slope else None,
        roll_off_to=slope[2] if slope else None,
        coherence=float(np.median(measured.coherence[np.isfinite(measured.coherence)])),
    )


def _trusted(measured: FrequencyResponse) -> Mask:
    return np.asarray((measured.coherence >= TRUSTED) & np.isfinite(measured.decibels))


def _isolation(f: Array, size: Array, trusted: Mask) -> float | None:
    """The frequency above the last line at or above 0 dB, where the curve crosses 0 dB."""
    at, level = f[trusted], size[trusted]
    loud = np.flatnonzero(level >= 0.0)
    if not loud.size:
        return float(at[0])
    last = int(loud[-1])
    if last + 1 >= at.size:
        return None
    share = level[last] / (level[last] - level[last + 1])
    return float(np.exp((1.0 - share) * np.log(at[last]) + share * np.log(at[last + 1])))


def roll_off(
    measured: FrequencyResponse, low: float, high: float = math.inf
) -> tuple[float, float, float] | None:
    """Give the slope of the level over the decades of frequency, by weighted least squares.

    Args:
        measured: the response.
        low, high: Hz, between which it is fitted where the coherence is at least 0.5.

    Returns:
        dB per decade, and the first and the last frequency that were used, Hz; None for too few lines.
    """
    f = measured.frequency
    use = _trusted(measured) & (f >= low) & (f <= high)
    if use.sum() < LEAST or f[use][-1] < 1.5 * f[use][0]:
        return None
    with np.errstate(invalid='ignore'):
        spread = np.hypot(np.nan_to_num(measured.radius / measured.magnitude), _FLOOR)
    basis = np.stack([np.log10(f[use]), np.ones(int(use.sum()))], axis=1) / spread[use, None]
    fitted = np.linalg.lstsq(basis, measured.decibels[use] / spread[use], rcond=None)[0]
    return float(fitted[0]), float(f[use][0]), float(f[use][-1])
