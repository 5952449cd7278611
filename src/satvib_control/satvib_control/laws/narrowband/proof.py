# SPDX-FileCopyrightText: 2026 The satvib authors
# SPDX-License-Identifier: Apache-2.0
"""Whether the voltage of each tone calms it; a tone that it does not calm is barred alone.

In the frame of x the tone's part in y, smoothed over two paces, is

    L = mean 2 y e^{-j arg x}.

With a right model |L| falls to a small share of |x| within a few paces, whatever the tone does. Where a mode of the
plant has moved and is fed, y is as large as what the tracker follows, and grows. So a tone is

    proven     |L| < 0.3 of |x|, until |L| > 0.7 of |x| for four paces,
    barred     |L| > 0.7 of |x| for one and a half paces, twice what the tone was at its start, and half of y^2.

It is barred only beside another tone that is proven: with one tone alone the whole law is judged (`backoff`). A tone
whose voltage is limited is not judged. A barred tone stays in the tracker, so it is no error of the others, and the
loop has no gain at its frequency. It gets no voltage for as long as the first hold, the next time four times as long.
All paces become twice as long, because the loop around the others may be what feeds the mode.

Without the share of y^2 a weak harmonic is barred for what is left of the strong one: on a wheel that runs up through
a mode the law lost all of its 2 dB.
"""

import math

from satvib_common.kernels.deferred import njit

from satvib_control.laws.narrowband.memory import Backoff, Setting, Tone, Tracking

CALMED = 0.3  # of |x|
NOT_CALMED = 0.7  # of |x|
LOUDER = 2.0  # times the amplitude at its start
MOST_OF_Y = 0.5  # share of y^2
PATIENCE = 1.5  # paces, to be barred
PATIENCE_PROVEN = 4.0  # paces, to be proven no longer
LONGER = 4.0  # factor on the next bar
LONGEST = 600.0  # first bars
SLOWER = 2.0  # factor on the paces
SLOWEST = 8.0  # largest one


@njit
def prove(memory, settings, share, y):
    """Judge every tone by a sample.

    Args:
        memory: changed.
        settings: of the law.
        share: (tones) of its voltage that the limit allows.
        y: m/s^2.
    """
    tones = memory.tones
    proven = 0
    for i in range(tones.shape[0]):
        if tones[i, Tone.ON] > 0.0 and tones[i, Tone.PROVEN] > 0.0:
            proven += 1
    for i in range(tones.shape[0]):
        t = tones[i]
        if t[Tone.ON] == 0.0 or t[Tone.PACE] == 0.0:
            continue
        others = proven - (1 if t[Tone.PROVEN] > 0.0 else 0)
        if _fails(t, memory, y, share[i]) and others > 0:
            _bar(t, memory, settings)


@njit
def _fails(t, memory, y, share):
    """Take a sample into L; whether the voltage of the tone does not calm it."""
    size = math.sqrt(t[Tone.RE] * t[Tone.RE] + t[Tone.IM] * t[Tone.IM]) + 1e-300
    pace = t[Tone.PACE] / memory.tracking[Tracking.STRETCH]
    # a slow tone is no more patient: its first estimate is as good
    weight = 0.5 / pace
    t[Tone.LEFT_RE] += (2.0 * y * t[Tone.RE] / size - t[Tone.LEFT_RE]) * weight
    t[Tone.LEFT_IM] += (-2.0 * y * t[Tone.IM] / size - t[Tone.LEFT_IM]) * weight
    if t[Tone.FADE] == 0.0:
        t[Tone.START] = size
    if t[Tone.FADE] < 0.5 or share < 1.0:
        t[Tone.TRIED] = 0.0
        return False
    left = math.sqrt(t[Tone.LEFT_RE] ** 2 + t[Tone.LEFT_IM] ** 2)
    if left < CALMED * size:
        t[Tone.PROVEN], t[Tone.TRIED] = 1.0, 0.0
    elif left > NOT_CALMED * size:
        t[Tone.TRIED] += 1.0 / pace
    if t[Tone.PROVEN] > 0.0:
        if t[Tone.TRIED] > PATIENCE_PROVEN:
            t[Tone.PROVEN], t[Tone.TRIED] = 0.0, 0.0
        return False
    grown = left > LOUDER * t[Tone.START]
    most = 0.5 * left * left > MOST_OF_Y * memory.backoff[Backoff.LEVEL]
    return grown and most and t[Tone.TRIED] > PATIENCE


@njit
def _bar(t, memory, settings):
    """No voltage for the tone alone, for a while; the others become slower."""
    tracking, first = memory.tracking, settings[Setting.FIRST_HOLD]
    length = max(tracking[Tracking.NEXT_BAR], first)
    tracking[Tracking.NEXT_BAR] = min(LONGER * length, LONGEST * first)
    tracking[Tracking.BARRED_OMEGA] = t[Tone.OMEGA]
    tracking[Tracking.BARRED_UNTIL] = tracking[Tracking.SEEN] + length
    t[Tone.BARRED], t[Tone.FADE], t[Tone.TRIED] = length, 0.0, 0.0
    slow = min(SLOWER * memory.backoff[Backoff.SLOW], SLOWEST)
    memory.backoff[Backoff.SLOW] = slow
    tracking[Tracking.STRETCH] = max(tracking[Tracking.STRETCH], slow)


@njit
def still_barred(t, tracking, window):
    """A tone that is found within a resolution of a barred one is that one."""
    left = tracking[Tracking.BARRED_UNTIL] - tracking[Tracking.SEEN]
    if left > 0.0 and abs(t[Tone.OMEGA] - tracking[Tracking.BARRED_OMEGA]) * window < 2.0 * math.pi:
        t[Tone.BARRED] = left
