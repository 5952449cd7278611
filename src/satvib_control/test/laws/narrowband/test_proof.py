# SPDX-FileCopyrightText: 2026 The satvib authors
# SPDX-License-Identifier: Apache-2.0
"""Tones are judged one by one: what their voltage leaves of them in y."""

import numpy as np
import pytest
from satvib_control.laws.narrowband.memory import (
    Backoff,
    Memory,
    Setting,
    Tone,
    Tracking,
)
from satvib_control.laws.narrowband.proof import prove, still_barred

PACE = 20.0
FIRST = 10.0 * PACE
GOOD, BAD = 0.31, 0.21  # rad/sample


class Strut:
    """Two tones of unit size that are tracked and served; y is put together from what is left of each."""

    def __init__(self, tones=(GOOD, BAD)):
        count = len(tones)
        self.memory = Memory.at_rest((), np.zeros(4), count, 100, 50)
        self.settings = np.zeros(len(Setting))
        self.settings[Setting.PACE], self.settings[Setting.FIRST_HOLD] = PACE, FIRST
        self.share, self.k, self.loudness = np.ones(count), 0, 1.0
        for t, omega in zip(self.memory.tones, tones, strict=True):
            t[[Tone.ON, Tone.OMEGA, Tone.PACE, Tone.FADE]] = 1.0, omega, PACE, 1.0
            t[Tone.START] = 1.0

    def run(self, count, *left, growth=1.0):
        """`count` samples in which the share `left` of each tone is in y, and the last tone grows by each sample."""
        for _ in range(count):
            y, y_power = 0.0, 0.0
            for i, (t, part) in enumerate(zip(self.memory.tones, left, strict=True)):
                size = np.hypot(t[Tone.RE], t[Tone.IM]) or 1.0
                size *= growth if i == len(left) - 1 else 1.0
                x = size * np.exp(1j * t[Tone.OMEGA] * self.k)
                t[Tone.RE], t[Tone.IM] = x.real, x.imag
                y += part * x.real
                y_power += (part * size) ** 2
            self.memory.tracking[Tracking.SEEN] = self.k
            self.memory.backoff[Backoff.LEVEL] = 0.5 * self.loudness * y_power
            prove(self.memory, self.settings, self.share, y)
            self.k += 1

    @property
    def barred(self):
        return [bool(t[Tone.BARRED] > 0.0) for t in self.memory.tones]


GROWTH = float(np.exp(0.1 / PACE))  # e times as large in ten paces, slower than L follows


def test_a_tone_that_grows_under_its_voltage_is_barred_alone():
    """Truth: the first tone is cancelled, the second stays whole in y and grows: only that one, for a first hold."""
    strut = Strut()
    strut.run(round(6.5 * PACE), 0.0, 1.0, growth=GROWTH)
    assert strut.barred == [False, False], 'not before it is twice as large'
    strut.run(round(4.5 * PACE), 0.0, 1.0, growth=GROWTH)
    assert strut.barred == [False, True]
    assert strut.memory.tones[1, Tone.BARRED] == FIRST
    assert strut.memory.tones[1, Tone.FADE] == 0.0
    assert strut.memory.tones[0, Tone.FADE] == 1.0
    assert strut.memory.backoff[Backoff.SLOW] == 2.0
    assert strut.memory.tracking[Tracking.STRETCH] == 2.0


@pytest.mark.parametrize(
    'case', ['calmed', 'alone', 'limited', 'not let through', 'steady', 'weak beside the rest of y']
)
def test_who_is_not_barred(case):
    """Truth: each lacks one of the conditions, and is otherwise as the tone that is barred."""
    strut = Strut()
    if case == 'limited':
        strut.share[1] = 0.5
    if case == 'not let through':
        strut.memory.tones[1, Tone.FADE] = 0.2
    if case == 'weak beside the rest of y':
        strut.loudness = 3.0
    left = {'calmed': (0.0, 0.1), 'alone': (1.0, 1.0)}.get(case, (0.0, 1.0))
    strut.run(round(20.0 * PACE), *left, growth=1.0 if case in {'steady', 'alone'} else GROWTH)
    assert strut.barred == [False, False]


def test_each_bar_is_four_times_as_long_as_the_one_before():
    """Truth: the text of the module."""
    strut = Strut()
    strut.memory.tracking[Tracking.NEXT_BAR] = 4.0 * FIRST
    strut.run(round(11.0 * PACE), 0.0, 1.0, growth=GROWTH)
    assert strut.memory.tones[1, Tone.BARRED] == 4.0 * FIRST
    assert strut.memory.tracking[Tracking.NEXT_BAR] == 16.0 * FIRST


def test_a_barred_tone_that_is_found_again_is_still_barred():
    """Truth: within a resolution of the window and before the bar is over, for the time that is left."""
    strut = Strut()
    strut.run(round(11.0 * PACE), 0.0, 1.0, growth=GROWTH)
    until = strut.memory.tracking[Tracking.BARRED_UNTIL]
    found = np.zeros(len(Tone))
    for omega, seen, left in (
        (BAD, until - 50.0, 50.0),
        (BAD + 1.1 * 2.0 * np.pi / 100.0, until - 50.0, 0.0),
        (BAD, until + 1.0, 0.0),
    ):
        found[:] = 0.0
        found[Tone.OMEGA] = omega
        strut.memory.tracking[Tracking.SEEN] = seen
        still_barred(found, strut.memory.tracking, 100)
        assert found[Tone.BARRED] == left
