# SPDX-FileCopyrightText: 2026 The satvib authors
# SPDX-License-Identifier: Apache-2.0
"""The back-off of law narrowband: when it takes the law for the cause, and for how long it holds it."""

import numpy as np
import pytest
from satvib_control.laws.narrowband.backoff import Verdict, restart, watch
from satvib_control.laws.narrowband.memory import Backoff, Setting, Tracking

PACE = 20.0
FIRST = 10.0 * PACE


@pytest.fixture
def strut():
    """A strut whose vibration of power 1/2 has been heard at 0 V for a hundred paces."""
    strut = Strut()
    strut.run(2000, 1.0, acting=False)
    return strut


class Strut:
    """A watch beside a tone of 20 samples, whose amplitude is given; the law acts where it is let."""

    def __init__(self):
        self.backoff, self.tracking = np.zeros(len(Backoff)), np.zeros(len(Tracking))
        self.settings, self.k = np.zeros(len(Setting)), 0
        self.caused, self.turned = 0, False
        self.backoff[Backoff.SLOW] = 1.0
        self.settings[Setting.PACE], self.settings[Setting.FIRST_HOLD] = PACE, FIRST

    def run(self, count, acting_amplitude, resting_amplitude=None, acting=True):
        """`count` samples; give which of them were at 0 V."""
        rest = np.zeros(count, dtype=bool)
        resting = acting_amplitude if resting_amplitude is None else resting_amplitude
        for i in range(count):
            on = self.backoff[Backoff.VOLTS] > 0.0
            y = (acting_amplitude if on else resting) * np.cos(np.pi / 10.0 * self.k)
            verdict = watch(self.backoff, self.tracking, self.settings, y, 0.0, acting, self.turned)
            rest[i] = verdict in {Verdict.TAKEN_OFF, Verdict.HELD}
            self.caused += verdict == Verdict.CAUSED
            volts = float(acting and not rest[i])
            self.backoff[Backoff.VOLTS] = self.backoff[Backoff.FADED] = volts
            self.k += 1
        return rest


def test_calm_is_not_disturbed(strut):
    """The law halves the amplitude: no hold; the base is what it was at 0 V, 1/2 within its ripple."""
    assert not strut.run(4000, 0.5).any()
    assert strut.backoff[Backoff.BASE] == pytest.approx(0.5, rel=0.1)


def test_a_law_that_makes_it_grow_is_the_cause(strut):
    """Three times as large with the voltage, as before without: held, each time four times as long, the base stays."""
    rest = strut.run(20000, 3.0, 1.0)
    edges = np.flatnonzero(np.diff(np.r_[0, rest.astype(int), 0]))
    lengths = edges[1::2] - edges[::2]
    np.testing.assert_allclose(lengths[:3], FIRST * np.array([1.0, 4.0, 16.0]), atol=2.0)
    assert strut.caused == 4
    assert strut.backoff[Backoff.SLOW] == 8.0
    assert strut.backoff[Backoff.BASE] == pytest.approx(0.5, rel=0.1)
    assert rest.mean() > 0.95


def test_a_disturbance_that_grows_is_not_caused_by_the_law(strut):
    """Three times as large whatever the voltage: it listens for three first holds, and has a new base."""
    rest = strut.run(round(3.0 * FIRST + 10.0 * PACE), 3.0)
    assert rest.sum() == pytest.approx(3.0 * FIRST, abs=3.0)
    assert strut.backoff[Backoff.BASE] == pytest.approx(4.5, rel=0.1)
    assert strut.caused == 0
    assert strut.backoff[Backoff.SLOW] == 1.0
    assert strut.backoff[Backoff.NEXT_HOLD] <= FIRST


def test_a_useless_voltage_is_taken_back(strut):
    """Neither louder nor calmer for twenty paces."""
    rest = strut.run(round(21.0 * PACE), 1.0)
    assert np.argmax(rest) == pytest.approx(20.0 * PACE, abs=2.0)
    strut.run(round(FIRST), 1.0)
    assert strut.backoff[Backoff.SLOW] == 2.0
    assert strut.caused == 0, 'what does nothing shows nothing'


def test_an_attempt_with_a_turned_model_is_taken_back_and_shows_it(strut):
    """Neither louder nor calmer: held at the first sample that says so, the cause at the end of the first hold."""
    assert not strut.run(round(5.0 * PACE), 1.0).any()
    strut.turned = True
    assert strut.run(1, 1.0).all()
    strut.turned = False
    rest = strut.run(round(FIRST + PACE), 1.0)
    assert rest.sum() == pytest.approx(FIRST, abs=2.0)
    assert strut.caused == 1
    assert strut.backoff[Backoff.NEXT_HOLD] == 4.0 * FIRST


def test_growth_of_another_strut_s_making_does_not_raise_the_base(strut):
    """Loud for the first half of the hold, until the other gives up: the base is what was left."""
    strut.run(round(6.0 * PACE), 3.0)
    assert strut.backoff[Backoff.HOLD] > 0.0
    strut.run(round(1.5 * FIRST), 3.0)
    strut.run(round(1.5 * FIRST), 1.0)
    assert strut.backoff[Backoff.BASE] == pytest.approx(0.5, rel=0.15)


def test_success_shortens_the_next_hold(strut):
    """After one harm, e-fold in a hundred paces of calm."""
    strut.run(round(FIRST + 10.0 * PACE), 3.0, 1.0)
    before = strut.backoff[Backoff.NEXT_HOLD]
    assert before == 4.0 * FIRST
    strut.backoff[Backoff.HOLD] = 0.0
    strut.run(round(100.0 * PACE), 0.1, 0.1)
    assert strut.backoff[Backoff.NEXT_HOLD] == pytest.approx(before / np.e, rel=0.1)


def test_a_corrected_model_begins_again_but_slowly(strut):
    """After a correction the hold is as the first; the pace is a quarter of what is wanted, or what it was."""
    strut.run(round(FIRST + 10.0 * PACE), 3.0, 1.0)
    assert (strut.backoff[Backoff.NEXT_HOLD], strut.backoff[Backoff.SLOW]) == (4.0 * FIRST, 2.0)
    restart(strut.backoff, strut.settings)
    assert (strut.backoff[Backoff.NEXT_HOLD], strut.backoff[Backoff.SLOW]) == (FIRST, 4.0)
    strut.backoff[Backoff.SLOW] = 8.0
    restart(strut.backoff, strut.settings)
    assert strut.backoff[Backoff.SLOW] == 8.0
