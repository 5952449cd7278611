# SPDX-FileCopyrightText: 2026 The satvib authors
# SPDX-License-Identifier: Apache-2.0
"""Power by frequency of a stretch of a run: third octaves of velocity against the criteria, cumulative RMS.

A stretch is short, and a third octave at 1 Hz is 0.23 Hz wide. So the lines are those of the whole stretch. The window
is Tukey's: 1, with Hann's flanks at either end, each a twentieth of the stretch and half a second at least. So a
vibration that grows or decays counts as it is, wherever in the stretch it is loud, and a tone stays within 2 Hz. The
lines are scaled so that their sum is the mean square of the stretch, that of the attenuation table. A band that is
narrower than a line is left out.

Criteria for vibration, RMS velocity in a third octave: the lines of ISO 2631-2 as C. G. Gordon used them (workshop to
operating theatre) and his VC curves (Proceedings of SPIE 1619, 1991; IEST-RP-CC012). The ISO lines, VC-A and VC-B are a
constant acceleration from 4 to 8 Hz and a constant velocity from 8 to 80 Hz; VC-C to VC-E are a constant velocity from
1 to 80 Hz.
"""

from typing import NamedTuple

import numpy as np
from satvib_common.arrays import Array


class Criterion(NamedTuple):
    """A limit: name; m/s RMS from `knee` to 80 Hz, below it constant acceleration, from `lowest` on, Hz."""

    name: str
    velocity: float
    lowest: float
    knee: float


CRITERIA = (
    Criterion('workshop (ISO)', 800e-6, 4.0, 8.0),
    Criterion('office (ISO)', 400e-6, 4.0, 8.0),
    Criterion('residential (ISO)', 200e-6, 4.0, 8.0),
    Criterion('operating theatre (ISO)', 100e-6, 4.0, 8.0),
    Criterion('VC-A', 50e-6, 4.0, 8.0),
    Criterion('VC-B', 25e-6, 4.0, 8.0),
    Criterion('VC-C', 12.5e-6, 1.0, 1.0),
    Criterion('VC-D', 6.25e-6, 1.0, 1.0),
    Criterion('VC-E', 3.12e-6, 1.0, 1.0),
)
HIGHEST = 80.0  # Hz, of all criteria
_FLANK = 0.05  # of the stretch, at either end
_SHORTEST_FLANK = 0.5  # s


def power_lines(signal: Array, dt: float) -> tuple[Array, Array]:
    """Give the mean square by frequency, without the mean value.

    Args:
        signal: (t, ...); a NaN counts as the mean.
        dt: s.

    Returns:
        Frequencies (f,) in Hz without 0, and the mean square (f, ...) of each line; they add up to that of the signal.
    """
    known = np.isfinite(signal)
    with np.errstate(invalid='ignore', divide='ignore'):
        mean = np.where(known, signal, 0.0).sum(axis=0) / known.sum(axis=0)
    around = np.where(known, signal - mean, 0.0)
    count = len(signal)
    rest = signal.ndim - 1
    lines = np.fft.rfft(around * _window(count, dt).reshape(-1, *([1] * rest)), axis=0)
    power = np.abs(lines[1:]) ** 2
    if count % 2 == 0:  # the other lines stand for two
        power[-1] *= 0.5
    found = power.sum(axis=0)
    whole = np.where(found > 0.0, np.mean(around * around, axis=0), 0.0)
    power *= whole / np.where(found > 0.0, found, 1.0)
    return np.asarray(np.fft.rfftfreq(count, dt)[1:], dtype=float), power


def _window(count: int, dt: float) -> Array:
    """Give Tukey's window (count,): 1, and Hann's flanks at either end; of a very short stretch Hann's whole window."""
    flank = min(max(_FLANK * count, _SHORTEST_FLANK / dt), 0.5 * count)
    k = np.arange(count)
    return np.asarray(0.5 - 0.5 * np.cos(np.pi * np.minimum(np.minimum(k, count - k) / flank, 1.0)))


def cumulative_rms(power: Array) -> Array:
    """Give the RMS (f, ...) of everything at and above each line, from the mean square of the lines (f, ...)."""
    return np.asarray(np.sqrt(np.cumsum(power[::-1], axis=0)[::-1]))


def integrated(frequency: Array, power: Array, times: int = 1) -> Array:
    """Give the mean square (f, ...) of the signal integrated `times` times over time."""
    factor = (2.0 * np.pi * frequency) ** (-2 * times)
    return np.asarray(power * factor.reshape(-1, *([1] * (power.ndim - 1))))


def third_octaves(
    frequency: Array, power: Array, low: float = 1.0, high: float = HIGHEST
) -> tuple[Array, Array]:
    """Give the RMS in third octaves (IEC 61260, base ten).

    Args:
        frequency: (f,) Hz, evenly spaced.
        power: (f, ...) mean square of each line.
        low, high: Hz, between which the centres lie.

    Returns:
        Centres (b,) in Hz and RMS (b, ...). Bands beyond the record, or narrower than its lines, are left out.
    """
    spacing = frequency[0]
    index = np.arange(round(10 * np.log10(low)), round(10 * np.log10(high)) + 1)
    centres = 10.0 ** (index / 10.0)
    edges = centres * 10.0**-0.05, centres * 10.0**0.05
    keep = (edges[1] - edges[0] >= spacing) & (edges[1] <= frequency[-1] + 0.5 * spacing)
    # each line is spread evenly over its width, so that a band takes its share of the lines at its edges
    borders = np.concatenate([[0.5 * spacing], frequency + 0.5 * spacing])
    flat = power.reshape(len(power), -1)
    total = np.concatenate([np.zeros((1, flat.shape[1])), np.cumsum(flat, axis=0)])
    found = [
        np.interp(edges[1][keep], borders, column) - np.interp(edges[0][keep], borders, column)
        for column in total.T
    ]
    rms = np.sqrt(np.maximum(np.stack(found, axis=-1), 0.0))
    return centres[keep], rms.reshape(-1, *power.shape[1:])


def criterion_limit(criterion: Criterion, frequency: Array) -> Array:
    """Give a criterion's velocity (f,) in m/s at (f,) Hz; NaN where it says nothing."""
    limit = criterion.velocity * np.maximum(criterion.knee / frequency, 1.0)
    slack = 10.0**0.05
    says = (frequency * slack >= criterion.lowest) & (frequency <= HIGHEST * slack)
    return np.asarray(np.where(says, limit, np.nan))


def met_criterion(centres: Array, velocity: Array) -> str:
    """Name the strictest criterion that a velocity (b,) in m/s RMS at third octaves (b,) stays below; '' for none."""
    met = ''
    for criterion in CRITERIA:
        limit = criterion_limit(criterion, centres)
        judged = np.isfinite(limit) & np.isfinite(velocity)
        if not judged.any() or np.any(velocity[judged] > limit[judged]):
            break
        met = criterion.name
    return met
