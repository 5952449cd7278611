# SPDX-FileCopyrightText: 2026 The satvib authors
# SPDX-License-Identifier: Apache-2.0
"""Finding tones that are not tracked yet: a short-time spectrum against its own floor.

Every twelfth of the window, the last `window` errors e of the tracker under Hann's window h give

    P(w) = |sum h e e^{-jwk}|^2 / sum h^2

on a grid of half a resolution (a resolution is 1 / window). P is the variance of e where e is white. The floor is the
running mean of P over 16 windows. In it a single value counts at most as eight times the level around it; the level
follows from the lower quartile of the 25 nearest points. So coloured noise becomes floor, and a single tone, which
takes nine points, does not. The largest P is a new tone when it is a local maximum, 25 times the floor, and 25 times
the level of the whole band. The vertex of the parabola through log P gives its frequency, correlation over the newer
half of the window its amplitude and phase. The tone is then taken out of the window, and the next one is searched.

Beside a tracked tone a peak whose power falls by half from the older to the newer half of the window is no tone: a mode
of the plant rings, where the model may be wrong. It is passed over.

A weaker tone is found by its constancy. P of Gaussian noise, however coloured, has mean P^2 = 2 (mean P)^2, that of a
tone (mean P)^2. Over eight windows mean P^2 < 1.3 (mean P)^2 with mean P above six times the level of the band is a
tone.

Side lobes come from what the subtraction leaves of a tone that began inside the window, and from the error of a tracker
that follows a jump. So for a window's length after a find or a jump only peaks above 1/16 of that tone count, and a
spectrum has a tenth of its weight in the floor. For two windows after a find nothing is searched within two resolutions
of the tone. Later the distance is three quarters of a resolution for a tone that has settled, 1.25 for one that has
not. Beside a tone the floor waits there, because a second tone is no noise.
"""

import math

import numpy as np
from satvib_common.kernels.deferred import njit

from satvib_control.laws.narrowband.memory import Floor, Setting, Tone, Tracking
from satvib_control.laws.narrowband.proof import still_barred
from satvib_control.laws.narrowband.tracker import begin

CLEAR = 25.0  # times floor and level: a tone
LOOKS_PER_WINDOW = 12
AROUND = 25  # points in the level around a point
QUARTILE = 0.2877  # lower quartile of an exponential distribution (which P has in noise) of mean 1
OUTLIER = 8.0  # times the level: the most that a value counts in the floor
FLOOR_WINDOWS = 16.0  # memory of the floor
WEAK = 6.0  # times the level of the band, for a weak tone
STEADY = 1.3  # largest mean P^2 / (mean P)^2 of a tone; noise has 2
STEADY_WINDOWS = 8.0  # memory of these means
SIDE_LOBE = 16.0  # a peak this much below a new tone may be its side lobe
WEIGHT_AFTER_NEWS = 0.1  # of a spectrum in the floor, while tones that settle hide the noise
DECAYED = 0.5  # power of the newer half of the window over that of the older one, below which a peak rings
RINGS = 2  # peaks that ring are passed over at each look
SETTLED, UNSETTLED = 0.75, 1.25  # resolutions around a tone in which nothing is searched


@njit
def search(tones, settings, tracking, ring, floor, step):
    """Look for new tones.

    Args:
        tones, tracking: changed.
        settings: of the law.
        ring: (window) errors of the tracker; what is found is taken out of it.
        floor: (Floor, g); changed.
        step: rad/sample; of the grid.
    """
    window, count = ring.shape[0], floor.shape[1]
    pointer, low = int(tracking[Tracking.POINTER]), settings[Setting.LOW]
    power = np.empty(count)
    quiet = tracking[Tracking.SEEN] - tracking[Tracking.NEWS] >= window
    first = quiet and not np.any(tones[:, Tone.ON] > 0.0)
    ringing = np.zeros(count, dtype=np.bool_)
    if quiet:
        tracking[Tracking.TOP] = 0.0
    band = 0.0
    for _ in range(tones.shape[0] + RINGS):
        spectrum(ring, pointer, low, step, power)
        band = np.sort(power)[count // 4] / QUARTILE
        best, top = _highest_peak(tones, settings, tracking, power, ringing, step, window)
        if best < 0 or not _stands_out(floor, best, top, band, tracking[Tracking.SPECTRA]):
            break
        omega = low + (best + _vertex(power, best, top)) * step
        if np.any(tones[:, Tone.ON] > 0.0) and rings(ring, pointer, omega):
            ringing[max(best - 2, 0) : best + 3] = True
            continue
        i = _free_place(tones, top, window)
        if i < 0:
            break
        _take(tones[i], ring, pointer, omega)
        still_barred(tones[i], tracking, window)
        tracking[Tracking.NEWS] = tracking[Tracking.SEEN]
        if first:
            tracking[Tracking.BAD_SAMPLES] = 0.0
        tracking[Tracking.TOP] = max(tracking[Tracking.TOP], top)
    _learn_floor(tones, settings, tracking, power, band, floor, step, window)


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
def _highest_peak(tones, settings, tracking, power, ringing, step, window):
    """Give place and P of the highest local maximum that may be a new tone; place -1: none."""
    best = -1
    least = max(settings[Setting.SMALLEST] ** 2 * window / 6.0, 1e-300)
    top = max(least, tracking[Tracking.TOP] / SIDE_LOBE)
    for q in range(1, power.shape[0] - 1):
        if power[q] < max(power[q - 1], power[q + 1]) or not power[q] > top or ringing[q]:
            continue
        omega = settings[Setting.LOW] + q * step
        if not settings[Setting.LEAST] - 0.5 * step < omega < settings[Setting.MOST] + 0.5 * step:
            continue
        if not _near(tones, omega, window, UNSETTLED, SETTLED):
            top = power[q]
            best = q
    return best, top


@njit
def _near(tones, omega, window, unsettled, settled):
    """Whether a frequency is near to a tracked tone.

    Within two resolutions for the first two windows after a find, then within `unsettled` or `settled`.
    """
    for i in range(tones.shape[0]):
        t = tones[i]
        if t[Tone.ON] > 0.0:
            around = 2.0
            if t[Tone.AGE] > 2.0 * window:
                around = settled if t[Tone.MEMORY] > 2.0 * window else unsettled
            if abs(t[Tone.OMEGA] - omega) * window < around * 2.0 * math.pi:
                return True
    return False


@njit
def _stands_out(floor, best, top, band, spectra):
    """Whether a peak is a tone: clear of the noise, or steady; the floor then forgets that it took it for noise."""
    if top >= CLEAR * max(band, floor[Floor.NOISE, best]):
        return True
    mean = floor[Floor.MEAN, best]
    constant = floor[Floor.SQUARE, best] < STEADY * mean * mean
    long = spectra >= STEADY_WINDOWS * LOOKS_PER_WINDOW
    if not (long and mean > WEAK * band and constant):
        return False
    for q in range(max(best - 4, 0), min(best + 5, floor.shape[1])):
        floor[Floor.NOISE, q] = min(floor[Floor.NOISE, q], band)
    return True


@njit
def _free_place(tones, power, window):
    """A place for a tone of that P: a free one, or the weakest if it has a quarter at most; -1: none."""
    weakest = -1
    least = 0.25 * power
    for i in range(tones.shape[0]):
        t = tones[i]
        if t[Tone.ON] == 0.0:
            return i
        square = t[Tone.RE] * t[Tone.RE] + t[Tone.IM] * t[Tone.IM]
        own = square * window / 6.0  # P of a tone under Hann's window
        if own < least:
            least = own
            weakest = i
    return weakest


@njit
def _vertex(power, best, top):
    """How far the vertex of the parabola through log P is from the highest point, in steps."""
    a = math.log(power[best - 1] + 1e-300)
    b = math.log(top)
    c = math.log(power[best + 1] + 1e-300)
    bend = a - 2.0 * b + c
    return 0.5 * (a - c) / bend if bend < 0.0 else 0.0


@njit
def rings(ring, pointer, omega):
    """Whether a component of the window decays, as a mode of the plant does that was struck, and a tone does not."""
    half = ring.shape[0] // 2
    re, im = _phasor(ring, pointer, omega, 0, half)
    old_re, old_im = _phasor(ring, pointer, omega, half, 2 * half)
    return re * re + im * im < DECAYED * (old_re * old_re + old_im * old_im)


@njit
def _phasor(ring, pointer, omega, first, last):
    """The component over the samples that are `first` to `last` - 1 samples old, turned to the newest one."""
    window = ring.shape[0]
    re = 0.0
    im = 0.0
    for i in range(first, last):
        value = ring[(pointer - 1 - i) % window]
        re += value * math.cos(omega * i)
        im += value * math.sin(omega * i)
    return re * 2.0 / (last - first), im * 2.0 / (last - first)


@njit
def _take(t, ring, pointer, omega):
    """Begin tone t at a frequency and take it out of the window; the newest sample is pointer - 1."""
    window = ring.shape[0]
    re, im = _phasor(ring, pointer, omega, 0, window // 2)
    begin(t, omega, re, im)
    for i in range(window):
        ring[(pointer - 1 - i) % window] -= re * math.cos(omega * i) + im * math.sin(omega * i)


@njit
def _learn_floor(tones, settings, tracking, power, band, floor, step, window):
    """Take a spectrum into the floor and into the means of P and P^2."""
    settling = tracking[Tracking.SEEN] - tracking[Tracking.NEWS] < window
    weight = WEIGHT_AFTER_NEWS if settling else 1.0
    spectra = min(tracking[Tracking.SPECTRA] + weight, FLOOR_WINDOWS * LOOKS_PER_WINDOW)
    tracking[Tracking.SPECTRA] = spectra
    recent = weight / min(spectra, STEADY_WINDOWS * LOOKS_PER_WINDOW)
    weight /= spectra
    level = np.empty(power.shape[0])
    _levels(power, level)
    for q in range(power.shape[0]):
        floor[Floor.MEAN, q] += (power[q] - floor[Floor.MEAN, q]) * recent
        floor[Floor.SQUARE, q] += (power[q] * power[q] - floor[Floor.SQUARE, q]) * recent
        value = min(power[q], OUTLIER * level[q])
        if _near(tones, settings[Setting.LOW] + q * step, window, 0.0, 0.0):
            value = max(
                floor[Floor.NOISE, q], band
            )  # there may be another tone, which is not noise
        floor[Floor.NOISE, q] += (value - floor[Floor.NOISE, q]) * weight


@njit
def _levels(power, out):
    """Level of the noise around each point, from the lower quartile of its `AROUND` nearest points."""
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
        out[q] = kept[rank] / QUARTILE


def grid_size(low: float, high: float, window: int) -> int:
    """Points of the grid of half a resolution, pi / window, from `low` to `high` (rad/sample)."""
    return max(int((high - low) * window / math.pi) + 1, 5)
