# SPDX-FileCopyrightText: 2026 The satvib authors
# SPDX-License-Identifier: Apache-2.0
"""An unbiased tracker of the tones of a signal: amplitude, phase, frequency and its rate.

Resonators share one error (a parallel observer: Peceli, IEEE Trans. Circuits and Systems 33 (1986) 658), so each
sees the signal without the others:

    x_i^- = e^{j w_i} x_i,    e = d - sum Re x_i^-,    x_i = x_i^- + (2 / n) e.

|x_i| is the amplitude, arg x_i the phase, and n, the pace, the samples in which they follow. Outside the notches e is d
itself: nothing pulls the frequency off the tone, while the poles of an AR(2) fit are drawn to the origin by noise. The
frequency follows from the phase error psi by a fading-memory filter (Morrison, Introduction to Sequential Smoothing and
Prediction, 1969) with a memory of N samples,

    psi = -2 e Im x^- / |x|^2,    w += r + (1 - b^2) psi / n,    r += 1.5 (1 - b)^2 psi / n,    b = 1 - 1 / N,

r being the rate, so that a chirp leaves no lag. While N grows and |r| is less than five times what noise alone makes
of it, r is forgotten within N / 4 samples, and a steady tone is tracked as by a filter of the order zero; so it is
while a fast tone (n below the wanted pace) has not got hold of the phase (q above 0.3 |x|), for a jump is no rate.
With r at rest var w = 4 s^2 / (A^2 N^2 n), s^2 being the local noise (see `tone_search`) and A the amplitude.

Variable forgetting. q, the quadrature of e in the frame of x over 2 n samples, has the variance s^2 / (6 n) as long
as the tone is what the tracker thinks. While q^2 is more than 24 times that, N falls, at a rate that grows with the
excess to one e-fold in 0.75 periods; else it grows by 0.4 per sample. Least squares over all k samples since have the
gains 4 / k and 6 / k^2, which is N = k / 2 here; by 0.4 what was wrong at the beginning is forgotten as 1 / k^2, while
with 1 / N^2 for the gain of r it would hardly be forgotten at all. The pace n is N / 6, at least one and a half
periods of the tone and 1.5 / |w_i - w_j| for its nearest neighbour, at most what is wanted, times the stretch of
`tone_margin`. With N >= 6 n the linearized loop has well-damped poles, and stands a rotation of e by 80 degrees.

A tone is lost, and its place free, when |x|^2 falls below four times what noise alone makes of it (2 s^2 / n).
"""

import math

from numba import njit

# places in a tone
RE, IM, OMEGA, RATE, MEMORY, ON, QUADRATURE, AGE, PACE = range(9)
FADE = 9
TONE = 10
# places in the settings: samples, samples, rad/sample, rad/sample, m/s^2, V, 1, samples
WANTED, LONGEST, LOW, HIGH, SMALLEST, VOLTAGE, PEAK, FIRST_HOLD, WINDOW = range(9)
SETTINGS = 9
# places in the common memory
POINTER, SEEN, STRETCH, HOPS, FRESH, TOP, SENSITIVITY = range(7)
POWER_E, POWER_D, QUIET, TROUBLE = range(7, 11)
# of `tone_watch`: powers of y and of the voltage's effect; what is known of the strut at 0 V; suspicion; the hold
LEVEL, HEARD, POWER_Y, POWER_U, RECENT = range(11, 16)
BASE, KNOWN, REST, LEAST, SILENT, ACTIVE, FADED = range(16, 23)
LOUD, USELESS, BEFORE, HOLD, EXTENDED, NEXT_HOLD, SLOW, TELLING = range(23, 31)
COMMON = 31

ALARM = 24.0
GROWTH = 0.4
TREND = 1.5  # gain of the rate times N^2
LOCK = 0.09  # (q / |x|)^2 up to which the phase counts as held
APART = 1.5  # shortest pace times the distance to the nearest tone, rad
SHORTEST = 3.0  # half periods of a tone in its shortest pace


@njit
def place(omega, low, step, count):
    """Index of a frequency on the grid of the noise floor, inside it."""
    return min(max(int((omega - low) / step + 0.5), 0), count - 1)


@njit
def predict(tones):
    """Turn every tone by one sample; give the sum of their real parts."""
    total = 0.0
    for i in range(tones.shape[0]):
        t = tones[i]
        if t[ON] == 0.0:
            continue
        c, s = math.cos(t[OMEGA]), math.sin(t[OMEGA])
        re = c * t[RE] - s * t[IM]
        t[IM] = s * t[RE] + c * t[IM]
        t[RE] = re
        total += re
    return total


@njit
def _shortest(tones, i):
    """Shortest pace of tone i: in periods, and in the beat with its nearest neighbour."""
    omega = tones[i, OMEGA]
    least = SHORTEST * math.pi / omega
    for j in range(tones.shape[0]):
        if j != i and tones[j, ON] > 0.0:
            least = max(least, APART / max(abs(tones[j, OMEGA] - omega), 0.1 * omega))
    return least


@njit
def correct(tones, settings, common, floor, step, e):
    """Take the shared error of a sample into every tone."""
    for i in range(tones.shape[0]):
        t = tones[i]
        if t[ON] == 0.0:
            continue
        least = _shortest(tones, i)
        n = common[STRETCH] * max(min(settings[WANTED], t[MEMORY] / 6.0), least)
        t[PACE] = n
        power = t[RE] * t[RE] + t[IM] * t[IM] + 1e-300
        amplitude = math.sqrt(power)
        noise = floor[place(t[OMEGA], settings[LOW], step, floor.shape[0])] + 1e-6 * power
        quadrature = -2.0 * e * t[IM] / amplitude
        t[RE] += 2.0 * e / n
        t[AGE] += 1.0
        t[QUADRATURE] += (quadrature - t[QUADRATURE]) / (2.0 * n)
        if power < 8.0 * noise / n:
            t[RATE] = 0.0
            continue  # too weak to have a phase
        psi = min(max(quadrature / amplitude, -1.0), 1.0) / n
        forget = 1.0 / max(t[MEMORY], 6.0 * n)
        t[OMEGA] += t[RATE] + (2.0 * forget - forget * forget) * psi
        if n < settings[WANTED] and t[QUADRATURE] * t[QUADRATURE] > LOCK * power:
            t[RATE] *= 1.0 - 4.0 * forget
        else:
            t[RATE] += TREND * forget * forget * psi
        excess = 6.0 * n * t[QUADRATURE] * t[QUADRATURE] / (ALARM * noise) - 1.0
        known = 33.0 * math.sqrt(noise * forget / power) * forget * forget
        if excess <= 0.0 and abs(t[RATE]) < known:
            t[RATE] *= 1.0 - 4.0 * forget
        if excess > 0.0:
            cut = min(0.25 * excess, 1.0) * 2.0 / least
            t[MEMORY] = max(t[MEMORY] * (1.0 - cut), 6.0 * least)
            if t[MEMORY] < 6.0 * settings[WANTED]:
                common[FRESH] = common[SEEN]
                common[TOP] = max(common[TOP], power * settings[WINDOW] / 6.0)
        else:
            t[MEMORY] = min(t[MEMORY] + GROWTH, settings[LONGEST])
        t[OMEGA] = min(max(t[OMEGA], settings[LOW]), settings[HIGH])


@njit
def prune(tones, settings, floor, step, window):
    """Let go of tones that are gone, have left the band or have become one with another."""
    for i in range(tones.shape[0]):
        t = tones[i]
        if t[ON] == 0.0:
            continue
        power = t[RE] * t[RE] + t[IM] * t[IM]
        noise = floor[place(t[OMEGA], settings[LOW], step, floor.shape[0])]
        least = max(8.0 * noise / t[PACE] if t[PACE] > 0.0 else 0.0, settings[SMALLEST] ** 2)
        outside = t[OMEGA] <= settings[LOW] or t[OMEGA] >= settings[HIGH]
        if outside or (t[AGE] > window and power < least):
            t[ON] = 0.0
            continue
        for j in range(i):
            other = tones[j]
            if other[ON] == 0.0 or abs(other[OMEGA] - t[OMEGA]) * settings[WANTED] > 1.0:
                continue
            if other[AGE] >= t[AGE]:
                other[RE] += t[RE]
                other[IM] += t[IM]
                t[ON] = 0.0
                break
            t[RE] += other[RE]
            t[IM] += other[IM]
            other[ON] = 0.0


@njit
def begin(t, omega, re, im):
    """Begin to track a tone that was found."""
    t[:] = 0.0
    t[RE], t[IM], t[OMEGA], t[ON] = re, im, omega, 1.0
    t[MEMORY] = 6.0 * SHORTEST * math.pi / omega
