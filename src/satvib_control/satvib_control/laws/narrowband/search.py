# SPDX-FileCopyrightText: 2026 The satvib authors
# SPDX-License-Identifier: Apache-2.0
"""Finding tones that nobody tracks yet: a short-time spectrum against its own floor.

Every twelfth of the window, the last `window` errors e of the tracker under Hann's window h give

    P(w) = |sum h e e^{-jwk}|^2 / sum h^2,

the variance of e where e is white, on a grid of half a resolution (a resolution is 1 / window). The floor is the
running mean of P over 16 windows, single values counted up to eight times the level around them, which the lower
quartile of the 25 nearest points tells. So coloured noise becomes floor, and a single tone, which takes nine points,
does not. The largest P is a new tone when it is a local maximum, 25 times the floor, and 25 times the level that the
lower quartile of the whole band tells. The vertex of the parabola through log P gives its frequency; correlation over
the newer half of the window its amplitude and phase. What is found leaves the window at once, and the next is sought.

A weak tone below that is told by its constancy. P of Gaussian noise, however coloured, has mean P^2 = 2 (mean P)^2,
that of a tone (mean P)^2. Over eight windows mean P^2 < 1.3 (mean P)^2 with mean P above six times the level of the
band is a tone.

Side lobes: what the subtraction leaves of a tone that began inside the window, and the error of a tracker that
follows a jump, have side lobes. So for a window's length after a find or a jump only peaks above 1/16 of that tone
count, and what P says of the noise counts a tenth. Within two resolutions of a tone nothing is sought for two windows
after its find, and the floor waits, for a second tone there is no noise; later within three quarters of a resolution
of a tone that has settled and 1.25 of one that has not.
"""

import math

import numpy as np
from numba import njit

from satvib_control.laws.narrowband.tracker import (
    AGE,
    FRESH,
    HOPS,
    IM,
    LOW,
    MEMORY,
    OMEGA,
    ON,
    POINTER,
    RE,
    SEEN,
    SMALLEST,
    TOP,
    TROUBLE,
    begin,
)

CLEAR = 25.0
HOPS_PER_WINDOW = 12
AROUND = 25
WEAK = 6.0
STEADY = 1.3
STEADY_WINDOWS = 8.0


@njit
def spectrum(ring, pointer, low, step, out):
    """P on the grid low + i step (rad/sample); `pointer` is the place of the oldest sample."""
    window = ring.shape[0]
    x = np.empty(window)
    power = 0.0
    for i in range(window):
        h = 0.5 - 0.5 * math.cos(2.0 * math.pi * (i + 0.5) / window)
        power += h * h
        x[i] = h * ring[(pointer + i) % window]
    for q in range(out.shape[0]):
        c = 2.0 * math.cos(low + q * step)
        s1 = 0.0
        s2 = 0.0
        for i in range(window):  # Goertzel
            s0 = x[i] + c * s1 - s2
            s2 = s1
            s1 = s0
        out[q] = max(s1 * s1 + s2 * s2 - c * s1 * s2, 0.0) / power


@njit
def _levels(power, out):
    """Level of the noise around each point: what the lower quartile of its `AROUND` nearest points tells."""
    count = power.shape[0]
    size = min(AROUND, count)
    rank = size // 4
    kept = np.empty(rank + 1)
    for q in range(count):
        first = min(max(q - size // 2, 0), count - size)
        filled = 0
        for i in range(first, first + size):  # the rank + 1 smallest, in order
            value = power[i]
            if filled == rank + 1 and value >= kept[rank]:
                continue
            j = min(filled, rank)
            while j > 0 and kept[j - 1] > value:
                kept[j] = kept[j - 1]
                j -= 1
            kept[j] = value
            filled = min(filled + 1, rank + 1)
        out[q] = kept[rank] / 0.2877


@njit
def _near(tones, omega, window, unsettled, settled):
    """Whether a frequency is near to a tracked tone.

    Within two resolutions for the first two windows after a find, then within `unsettled` or `settled`.
    """
    for i in range(tones.shape[0]):
        t = tones[i]
        if t[ON] > 0.0:
            around = 2.0
            if t[AGE] > 2.0 * window:
                around = settled if t[MEMORY] > 2.0 * window else unsettled
            if abs(t[OMEGA] - omega) * window < around * 2.0 * math.pi:
                return True
    return False


@njit
def _free(tones, power, window):
    """A place for a tone of that P: a free one, or the weakest if it has a quarter at most; -1: none."""
    weakest = -1
    least = 0.25 * power
    for i in range(tones.shape[0]):
        t = tones[i]
        if t[ON] == 0.0:
            return i
        own = (t[RE] * t[RE] + t[IM] * t[IM]) * window / 6.0  # P of a tone under Hann's window
        if own < least:
            least = own
            weakest = i
    return weakest


@njit
def _take(t, ring, pointer, omega):
    """Begin tone t at a frequency and take it out of the window; the newest sample is pointer - 1."""
    window = ring.shape[0]
    half = window // 2
    re = 0.0
    im = 0.0
    for i in range(half):
        value = ring[(pointer - 1 - i) % window]
        re += value * math.cos(omega * i)
        im += value * math.sin(omega * i)
    re *= 2.0 / half
    im *= 2.0 / half
    begin(t, omega, re, im)
    for i in range(window):
        ring[(pointer - 1 - i) % window] -= re * math.cos(omega * i) + im * math.sin(omega * i)


@njit
def _steady(floor, q, lowest, hops):
    """Whether P at a point of the grid has long been that of a weak tone: above the band, and always the same."""
    mean = floor[1, q]
    constant = floor[2, q] < STEADY * mean * mean
    return hops >= STEADY_WINDOWS * HOPS_PER_WINDOW and mean > WEAK * lowest and constant


@njit
def search(tones, settings, common, ring, floor, step):
    """Look for new tones; the last sample of `ring` is the newest error.

    `floor` (3, g): the noise floor, and the running means of P and P^2.
    """
    window, count = ring.shape[0], floor.shape[1]
    pointer = int(common[POINTER])
    power = np.empty(count)
    level = np.empty(count)
    least = max(settings[SMALLEST] ** 2 * window / 6.0, 1e-300)
    calm = common[SEEN] - common[FRESH] >= window
    fresh = calm and not np.any(tones[:, ON] > 0.0)
    if calm:
        common[TOP] = 0.0
    lowest = 0.0
    for _ in range(tones.shape[0]):
        spectrum(ring, pointer, settings[LOW], step, power)
        lowest = np.sort(power)[count // 4] / 0.2877
        best = -1
        top = max(least, common[TOP] / 16.0)
        for q in range(1, count - 1):
            if power[q] < max(power[q - 1], power[q + 1]):
                continue
            if power[q] > top and not _near(tones, settings[LOW] + q * step, window, 1.25, 0.75):
                top = power[q]
                best = q
        if best < 0:
            break
        if top < CLEAR * max(lowest, floor[0, best]):
            if not _steady(floor, best, lowest, common[HOPS]):
                break
            for q in range(max(best - 4, 0), min(best + 5, count)):
                floor[0, q] = min(
                    floor[0, q], lowest
                )  # what was taken for noise there was the tone
        i = _free(tones, top, window)
        if i < 0:
            break
        a = math.log(power[best - 1] + 1e-300)
        b = math.log(top)
        c = math.log(power[best + 1] + 1e-300)
        bend = a - 2.0 * b + c
        shift = 0.5 * (a - c) / bend if bend < 0.0 else 0.0
        _take(tones[i], ring, pointer, settings[LOW] + (best + shift) * step)
        common[FRESH] = common[SEEN]
        if fresh:
            common[TROUBLE] = 0.0
        common[TOP] = max(common[TOP], top)
    # tones that settle hide the noise: the spectrum says little then, and is taken with a tenth of the weight
    weight = 0.1 if common[SEEN] - common[FRESH] < window else 1.0
    common[HOPS] = min(common[HOPS] + weight, 16.0 * HOPS_PER_WINDOW)
    recent = weight / min(common[HOPS], STEADY_WINDOWS * HOPS_PER_WINDOW)
    weight /= common[HOPS]
    _levels(power, level)
    for q in range(count):
        floor[1, q] += (power[q] - floor[1, q]) * recent
        floor[2, q] += (power[q] * power[q] - floor[2, q]) * recent
        value = min(power[q], 8.0 * level[q])
        if _near(tones, settings[LOW] + q * step, window, 0.0, 0.0):
            value = max(floor[0, q], lowest)  # there may be another tone, which is not noise
        floor[0, q] += (value - floor[0, q]) * weight


def grid_size(low: float, high: float, window: int) -> int:
    """Points of the grid of half a resolution, pi / window, from `low` to `high` (rad/sample)."""
    return max(int((high - low) * window / math.pi) + 1, 5)
