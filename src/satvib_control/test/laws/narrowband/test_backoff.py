# SPDX-FileCopyrightText: 2026 The satvib authors
# SPDX-License-Identifier: Apache-2.0
"""The watch over what the voltage of law narrowband does: whom it blames, and for how long."""

import numpy as np
import pytest
from satvib_control.laws.narrowband import tracker as tt
from satvib_control.laws.narrowband.backoff import believe, held

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
        self.common, self.settings, self.k = np.zeros(tt.COMMON), np.zeros(tt.SETTINGS), 0
        self.verdicts, self.astray = 0, False
        self.common[tt.SLOW] = 1.0
        self.settings[tt.WANTED], self.settings[tt.FIRST_HOLD] = PACE, FIRST

    def run(self, count, acting_amplitude, resting_amplitude=None, acting=True):
        """`count` samples; give which of them were at 0 V."""
        rest = np.zeros(count, dtype=bool)
        resting = acting_amplitude if resting_amplitude is None else resting_amplitude
        for i in range(count):
            on = self.common[tt.ACTIVE] > 0.0
            y = (acting_amplitude if on else resting) * np.cos(np.pi / 10.0 * self.k)
            rest[i], _, guilty = held(self.common, self.settings, y, y, acting, self.astray)
            self.verdicts += guilty
            self.common[tt.ACTIVE] = self.common[tt.FADED] = float(acting and not rest[i])
            self.k += 1
        return rest


def test_calm_is_not_disturbed(strut):
    """The law halves the amplitude: no hold; the base is what it was at 0 V, 1/2 within its ripple."""
    assert not strut.run(4000, 0.5).any()
    assert strut.common[tt.BASE] == pytest.approx(0.5, rel=0.1)


def test_who_makes_it_grow_is_guilty(strut):
    """Three times as large with the voltage, as before without: held, each time four times as long, the base stays."""
    rest = strut.run(20000, 3.0, 1.0)
    edges = np.flatnonzero(np.diff(np.r_[0, rest.astype(int), 0]))
    lengths = edges[1::2] - edges[::2]
    np.testing.assert_allclose(lengths[:3], FIRST * np.array([1.0, 4.0, 16.0]), atol=2.0)
    assert strut.verdicts == 4
    assert strut.common[tt.SLOW] == 8.0
    assert strut.common[tt.BASE] == pytest.approx(0.5, rel=0.1)
    assert rest.mean() > 0.95


def test_a_disturbance_that_grows_is_no_guilt(strut):
    """Three times as large whatever the voltage: it listens for three first holds, and has a new base."""
    rest = strut.run(round(3.0 * FIRST + 10.0 * PACE), 3.0)
    assert rest.sum() == pytest.approx(3.0 * FIRST, abs=3.0)
    assert strut.common[tt.BASE] == pytest.approx(4.5, rel=0.1)
    assert strut.verdicts == 0
    assert strut.common[tt.SLOW] == 1.0
    assert strut.common[tt.NEXT_HOLD] <= FIRST


def test_a_useless_voltage_is_taken_back(strut):
    """Neither louder nor calmer for twenty paces."""
    rest = strut.run(round(21.0 * PACE), 1.0)
    assert np.argmax(rest) == pytest.approx(20.0 * PACE, abs=2.0)
    strut.run(round(FIRST), 1.0)
    assert strut.common[tt.SLOW] == 2.0
    assert strut.verdicts == 0, 'what does nothing teaches nothing'


def test_an_attempt_that_went_astray_is_taken_back_and_teaches(strut):
    """Neither louder nor calmer: held at the first sample that says so, guilty at the end of the first hold."""
    assert not strut.run(round(5.0 * PACE), 1.0).any()
    strut.astray = True
    assert strut.run(1, 1.0).all()
    strut.astray = False
    rest = strut.run(round(FIRST + PACE), 1.0)
    assert rest.sum() == pytest.approx(FIRST, abs=2.0)
    assert strut.verdicts == 1
    assert strut.common[tt.NEXT_HOLD] == 4.0 * FIRST


def test_growth_of_another_strut_s_making_does_not_raise_the_base(strut):
    """Loud for the first half of the hold, until the other gives up: the base is what was left."""
    strut.run(round(6.0 * PACE), 3.0)
    assert strut.common[tt.HOLD] > 0.0
    strut.run(round(1.5 * FIRST), 3.0)
    strut.run(round(1.5 * FIRST), 1.0)
    assert strut.common[tt.BASE] == pytest.approx(0.5, rel=0.15)


def test_success_shortens_the_next_hold(strut):
    """After one charge, e-fold in a hundred paces of calm."""
    strut.run(round(FIRST + 10.0 * PACE), 3.0, 1.0)
    before = strut.common[tt.NEXT_HOLD]
    assert before == 4.0 * FIRST
    strut.common[tt.HOLD] = 0.0
    strut.run(round(100.0 * PACE), 0.1, 0.1)
    assert strut.common[tt.NEXT_HOLD] == pytest.approx(before / np.e, rel=0.1)


def test_a_corrected_model_begins_anew_but_slowly(strut):
    """After three charges the hold is as the first; the pace is a quarter of what is wanted, or what it was."""
    strut.run(round(FIRST + 10.0 * PACE), 3.0, 1.0)
    assert (strut.common[tt.NEXT_HOLD], strut.common[tt.SLOW]) == (4.0 * FIRST, 2.0)
    believe(strut.common, strut.settings)
    assert (strut.common[tt.NEXT_HOLD], strut.common[tt.SLOW]) == (FIRST, 4.0)
    strut.common[tt.SLOW] = 8.0
    believe(strut.common, strut.settings)
    assert strut.common[tt.SLOW] == 8.0
