# SPDX-FileCopyrightText: 2026 The satvib authors
# SPDX-License-Identifier: Apache-2.0
"""An unbiased tracker of the tones of a signal: amplitude, phase, frequency and its rate.

Resonators share one error (a parallel observer: Peceli, IEEE Trans. Circuits and Systems 33 (1986) 658), so each
sees the signal without the others:

    x_i^- = e^{j w_i} x_i,    e = d - sum Re x_i^-,    x_i = x_i^- + (2 / n) e.

|x_i| is the amplitude, arg x_i the phase, and n, the pace, the number of samples in which they follow. Outside the
notches e is d itself: nothing pulls the frequency off the tone. (Noise draws the poles of an AR(2) fit to the origin.)
The frequency follows from the phase error psi by a fading-memory filter (Morrison, Introduction to Sequential Smoothing
and Prediction, 1969) with a memory of N samples,

    psi = -2 e Im x^- / |x|^2,    w += r + (1 - b^2) psi / n,    r += 1.5 (1 - b)^2 psi / n,    b = 1 - 1 / N.

r is the rate of the frequency, so a chirp leaves no lag. The rate is forgotten within N / 4 samples in two cases, and
the frequency is then tracked as by a filter of order zero. First, N grows and |r| is less than five times what noise
alone makes of it. Second, a fast tone (n below the wanted pace) has not locked to the phase (q above 0.3 |x|), because
a jump is no rate. With r at rest var w = 4 s^2 / (A^2 N^2 n), with the local noise s^2 (see `search`) and the
amplitude A.

Variable forgetting. q is the quadrature of e in the frame of x, averaged over 2 n samples. Its variance is s^2 / (6 n)
as long as the tone is what the tracker assumes. While q^2 is more than 24 times that, N falls, faster with the excess,
by up to one e-fold in 0.75 periods. Otherwise N grows by 0.4 per sample. Least squares over all k samples since have
the gains 4 / k and 6 / k^2, which is N = k / 2 here. With 0.4 the error of the beginning is forgotten as 1 / k^2; with
a gain of 1 / N^2 for r it would hardly be forgotten at all. The pace n is N / 6. It is at least one and a half periods
of the tone and 1.5 / |w_i - w_j| for its nearest neighbour, at most the wanted pace, and multiplied by the stretch of
`margin`. With N >= 6 n the linearized loop has well-damped poles and tolerates a rotation of e by 80 degrees.

A tone is lost, and its place free, when |x|^2 falls below four times what noise alone makes of it (2 s^2 / n).

`lost`: for a whole window the tones have explained less than four fifths of the disturbance, and there is more than
four times the usual error. The tracker cannot catch up any more (three tones that jumped at once, for example). The law
then searches again in the window, which by then holds the new tones only.
"""

import math

from satvib_common.kernels.deferred import njit

from satvib_control.laws.narrowband.memory import Setting, Tone, Tracking

ALARM = 24.0  # times the variance of q in noise
GROWTH = 0.4  # of N per sample
TREND = 1.5  # gain of the rate times N^2
LOCKED = 0.09  # (q / |x|)^2 up to which the phase counts as locked
APART = 1.5  # rad; shortest pace times the distance to the nearest tone
SHORTEST = 3.0  # half periods of a tone in its shortest pace
PACES = 6.0  # in the shortest memory
WEIGHT_AFTER_NEWS = 0.02  # of the error in its usual power, in the window after a find or a jump
UNEXPLAINED = 0.2  # share of the disturbance's power in e above which the tones explain too little
UNUSUAL = 4.0  # times the usual power of e above which the same


@njit
def place(omega, low, step, count):
    """Index of a frequency on the grid of the noise floor, inside it."""
    return min(max(int((omega - low) / step + 0.5), 0), count - 1)


@njit
def begin(t, omega, re, im):
    """Begin to track a tone that was found."""
    t[:] = 0.0
    t[Tone.RE], t[Tone.IM], t[Tone.OMEGA], t[Tone.ON] = re, im, omega, 1.0
    t[Tone.MEMORY] = PACES * SHORTEST * math.pi / omega


@njit
def predict(tones):
    """Turn every tone by one sample; give the sum of their real parts."""
    total = 0.0
    for i in range(tones.shape[0]):
        t = tones[i]
        if t[Tone.ON] == 0.0:
            continue
        c, s = math.cos(t[Tone.OMEGA]), math.sin(t[Tone.OMEGA])
        re = c * t[Tone.RE] - s * t[Tone.IM]
        t[Tone.IM] = s * t[Tone.RE] + c * t[Tone.IM]
        t[Tone.RE] = re
        total += re
    return total


@njit
def correct(tones, settings, tracking, noise, step, e):
    """Take the shared error of a sample into every tone; `noise` is the floor, `step` that of its grid."""
    for i in range(tones.shape[0]):
        t = tones[i]
        if t[Tone.ON] == 0.0:
            continue
        shortest = _shortest_pace(tones, i)
        wanted = min(settings[Setting.PACE], t[Tone.MEMORY] / PACES)
        t[Tone.PACE] = tracking[Tracking.STRETCH] * max(wanted, shortest)
        power = t[Tone.RE] * t[Tone.RE] + t[Tone.IM] * t[Tone.IM] + 1e-300
        local = noise[place(t[Tone.OMEGA], settings[Setting.LOW], step, noise.shape[0])]
        local += 1e-6 * power
        quadrature = _correct_phasor(t, power, e)
        if power < 8.0 * local / t[Tone.PACE]:
            t[Tone.RATE] = 0.0
            continue  # too weak to have a phase
        excess = _correct_frequency(t, settings, power, local, quadrature)
        _adapt_memory(t, settings, tracking, power, excess, shortest)
        t[Tone.OMEGA] = min(max(t[Tone.OMEGA], settings[Setting.LOW]), settings[Setting.HIGH])


@njit
def _shortest_pace(tones, i):
    """Shortest pace of tone i: in periods, and in the beat with its nearest neighbour."""
    omega = tones[i, Tone.OMEGA]
    shortest = SHORTEST * math.pi / omega
    for j in range(tones.shape[0]):
        if j != i and tones[j, Tone.ON] > 0.0:
            apart = max(abs(tones[j, Tone.OMEGA] - omega), 0.1 * omega)
            shortest = max(shortest, APART / apart)
    return shortest


@njit
def _correct_phasor(t, power, e):
    """Take the error into x and q; give the quadrature of this sample (m/s^2)."""
    n = t[Tone.PACE]
    quadrature = -2.0 * e * t[Tone.IM] / math.sqrt(power)
    t[Tone.RE] += 2.0 * e / n
    t[Tone.AGE] += 1.0
    t[Tone.QUADRATURE] += (quadrature - t[Tone.QUADRATURE]) / (2.0 * n)
    return quadrature


@njit
def _correct_frequency(t, settings, power, noise, quadrature):
    """Take the phase error into frequency and rate; give by how much q exceeds what noise explains."""
    n = t[Tone.PACE]
    psi = min(max(quadrature / math.sqrt(power), -1.0), 1.0) / n
    forget = 1.0 / max(t[Tone.MEMORY], PACES * n)
    t[Tone.OMEGA] += t[Tone.RATE] + (2.0 * forget - forget * forget) * psi
    square = t[Tone.QUADRATURE] * t[Tone.QUADRATURE]
    if n < settings[Setting.PACE] and square > LOCKED * power:
        t[Tone.RATE] *= 1.0 - 4.0 * forget
    else:
        t[Tone.RATE] += TREND * forget * forget * psi
    excess = 6.0 * n * t[Tone.QUADRATURE] * t[Tone.QUADRATURE] / (ALARM * noise) - 1.0
    by_noise = 33.0 * math.sqrt(noise * forget / power) * forget * forget
    if excess <= 0.0 and abs(t[Tone.RATE]) < by_noise:
        t[Tone.RATE] *= 1.0 - 4.0 * forget
    return excess


@njit
def _adapt_memory(t, settings, tracking, power, excess, shortest):
    """Shorten the memory of the frequency where q is more than noise explains, else lengthen it."""
    if excess <= 0.0:
        t[Tone.MEMORY] = min(t[Tone.MEMORY] + GROWTH, settings[Setting.LONGEST])
        return
    cut = min(0.25 * excess, 1.0) * 2.0 / shortest
    t[Tone.MEMORY] = max(t[Tone.MEMORY] * (1.0 - cut), PACES * shortest)
    if t[Tone.MEMORY] < PACES * settings[Setting.PACE]:
        tracking[Tracking.NEWS] = tracking[Tracking.SEEN]
        jumped = power * settings[Setting.WINDOW] / 6.0
        tracking[Tracking.TOP] = max(tracking[Tracking.TOP], jumped)


@njit
def lost(tracking, settings, e, d):
    """Whether for a whole window the tones have explained less than four fifths of the disturbance."""
    window = settings[Setting.WINDOW]
    tracking[Tracking.ERROR_POWER] += (e * e - tracking[Tracking.ERROR_POWER]) * 4.0 / window
    old = tracking[Tracking.DISTURBANCE_POWER]
    tracking[Tracking.DISTURBANCE_POWER] += (d * d - old) * 4.0 / window
    error, disturbance = tracking[Tracking.ERROR_POWER], tracking[Tracking.DISTURBANCE_POWER]
    seen = tracking[Tracking.SEEN]
    weight = WEIGHT_AFTER_NEWS if seen - tracking[Tracking.NEWS] < window else 1.0
    usual = tracking[Tracking.USUAL_ERROR]
    usual += (error - usual) * weight / min(16.0 * window, seen)
    tracking[Tracking.USUAL_ERROR] = usual
    if error > UNEXPLAINED * disturbance and error > UNUSUAL * usual:
        tracking[Tracking.BAD_SAMPLES] += 1.0
    else:
        tracking[Tracking.BAD_SAMPLES] = max(tracking[Tracking.BAD_SAMPLES] - 4.0, 0.0)
    return tracking[Tracking.BAD_SAMPLES] > window


@njit
def prune(tones, settings, noise, step, window):
    """Free the places of tones that are lost, have left the band or have become one with another."""
    for i in range(tones.shape[0]):
        t = tones[i]
        if t[Tone.ON] == 0.0:
            continue
        power = t[Tone.RE] * t[Tone.RE] + t[Tone.IM] * t[Tone.IM]
        local = noise[place(t[Tone.OMEGA], settings[Setting.LOW], step, noise.shape[0])]
        by_noise = 8.0 * local / t[Tone.PACE] if t[Tone.PACE] > 0.0 else 0.0
        least = max(by_noise, settings[Setting.SMALLEST] ** 2)
        low, high = settings[Setting.LEAST] - step, settings[Setting.MOST] + step
        outside = t[Tone.OMEGA] <= low or t[Tone.OMEGA] >= high
        if outside or (t[Tone.AGE] > window and power < least):
            t[Tone.ON] = 0.0
        else:
            _merge(tones, i, settings[Setting.PACE])


@njit
def _merge(tones, i, pace):
    """Add tone i to an earlier one of the same frequency, or that one to tone i; the older of the two stays."""
    t = tones[i]
    for j in range(i):
        other = tones[j]
        if other[Tone.ON] == 0.0 or abs(other[Tone.OMEGA] - t[Tone.OMEGA]) * pace > 1.0:
            continue
        if other[Tone.AGE] >= t[Tone.AGE]:
            other[Tone.RE] += t[Tone.RE]
            other[Tone.IM] += t[Tone.IM]
            t[Tone.ON] = 0.0
            break
        t[Tone.RE] += other[Tone.RE]
        t[Tone.IM] += other[Tone.IM]
        other[Tone.ON] = 0.0
