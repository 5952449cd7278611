# SPDX-FileCopyrightText: 2026 The satvib authors
# SPDX-License-Identifier: Apache-2.0
"""Finding tones that nobody tracks yet: a short-time spectrum against its own floor.

Every twelfth of the window, the last `window` errors e of the tracker under Hann's window h give

    P(w) = |sum h e e^{-jwk}|^2 / sum h^2,

the variance of e where e is white. The level of the band is told by the lower quartile of P, which three tones do
not reach; the floor at each frequency is the running mean of P over 16 windows, single values counted up to eight
times the level. The largest P is a new tone when it is a local maximum, and 25 times the floor there and the level.
The vertex of the parabola through log P gives its frequency; correlation over the newer half of the window its
amplitude and phase. What is found leaves the window at once, and the next is sought.

Side lobes: what the subtraction leaves of a tone that began inside the window, and the error of a tracker that
follows a jump, have side lobes. So for a window's length after a find or a jump only peaks above 1/16 of that tone
count. Around a tone that is settling two resolutions (1 / window) are not searched, around a settled one three
quarters of one.
"""

import math

import numpy as np
from numba import njit

from satvib_control.tone_tracker import (
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


@njit
def spectrum(ring, pointer, low, step, out):  # type: ignore[no-untyped-def]  # noqa: ANN001, ANN201
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
def _hidden(tones, omega, window):  # type: ignore[no-untyped-def]  # noqa: ANN001, ANN202
    """Whether a frequency lies too near to a tone that is tracked."""
    resolution = 2.0 * math.pi / window
    for i in range(tones.shape[0]):
        t = tones[i]
        if t[ON] > 0.0:
            settled = t[MEMORY] > 2.0 * window and t[AGE] > 2.0 * window
            if abs(t[OMEGA] - omega) < (0.75 if settled else 2.0) * resolution:
                return True
    return False


@njit
def _free(tones, power, window):  # type: ignore[no-untyped-def]  # noqa: ANN001, ANN202
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
def _take(t, ring, pointer, omega):  # type: ignore[no-untyped-def]  # noqa: ANN001, ANN202
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
def search(tones, settings, common, ring, floor, step):  # type: ignore[no-untyped-def]  # noqa: ANN001, ANN201
    """Look for new tones; the last sample of `ring` is the newest error."""
    window, count = ring.shape[0], floor.shape[0]
    pointer = int(common[POINTER])
    power = np.empty(count)
    least = max(settings[SMALLEST] ** 2 * window / 6.0, 1e-300)
    mean = 0.0
    calm = common[SEEN] - common[FRESH] >= window
    fresh = calm and not np.any(tones[:, ON] > 0.0)
    if calm:
        common[TOP] = 0.0
    for _ in range(tones.shape[0]):
        spectrum(ring, pointer, settings[LOW], step, power)
        mean = np.sort(power)[count // 4] / 0.2877
        best = -1
        top = max(least, common[TOP] / 16.0)
        for q in range(1, count - 1):
            if power[q] > top and not _hidden(tones, settings[LOW] + q * step, window):
                top = power[q]
                best = q
        if best < 0 or power[best - 1] > top or power[best + 1] > top:
            break
        if top < CLEAR * max(mean, floor[best]):
            break
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
    common[HOPS] = min(common[HOPS] + 1.0, 16.0 * HOPS_PER_WINDOW)
    weight = 1.0 / common[HOPS]
    if common[SEEN] - common[FRESH] < window:
        weight *= 0.1  # tones are settling: the spectrum is hardly one of noise
    for q in range(count):
        value = min(power[q], 8.0 * mean)
        floor[q] += (value - floor[q]) * weight


def grid_size(low: float, high: float, window: int) -> int:
    """Points of the grid of half a resolution, pi / window, from `low` to `high` (rad/sample)."""
    return max(int((high - low) * window / math.pi) + 1, 5)
