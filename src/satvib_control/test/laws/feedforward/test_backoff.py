# SPDX-FileCopyrightText: 2026 The satvib authors
# SPDX-License-Identifier: Apache-2.0
"""When feedforward learns, acts and backs off, sample by sample."""

from copy import deepcopy

import numpy as np
import pytest
from satvib_control.laws.feedforward.backoff import Backoff, BackoffState

LISTEN, ACT, FADE, RESTART, RING_DOWN, GIVEN_UP = BackoffState
WINDOW = 50


def fresh(shape=()):
    backoff = Backoff(shape)
    backoff.tune(WINDOW, 3.0, 0.02)
    return backoff


def judge(backoff, error, reference, effect=0.0, cut=False, valid=True, acting=True, count=1):
    for _ in range(count):
        state, loud = backoff.step(error, reference, effect, cut, valid, acting)
    return int(state), bool(loud)


def heard(ratio=1.0):
    """A backoff that has listened, with y / x = ratio, and has let its voltage in."""
    backoff = fresh()
    judge(backoff, ratio, 1.0, count=150)
    assert backoff.share == 1.0
    return backoff


def test_it_listens_for_a_watch_time_and_lets_the_voltage_in_over_half_of_one():
    """Truth: 50 samples of listening, learning from the 38th on, r_0 = 0.25, then 25 of fading in."""
    backoff = fresh()
    assert judge(backoff, 0.5, 1.0, count=37) == (LISTEN, False)
    assert judge(backoff, 0.5, 1.0, count=12) == (LISTEN, True)
    assert backoff.share == 0.0
    judge(backoff, 0.5, 1.0)
    assert backoff.passed == pytest.approx(0.25)
    assert judge(backoff, 0.5, 1.0, count=5) == (ACT, True)
    assert backoff.share == pytest.approx(5 / 25)
    judge(backoff, 0.5, 1.0, count=30)
    assert backoff.share == 1.0


def test_nothing_is_learnt_from_silence():
    """Truth: below the floor it goes on listening."""
    backoff = fresh()
    assert judge(backoff, 0.01, 0.01, count=1000) == (LISTEN, False)


def test_a_payload_that_rings_is_not_a_reference():
    """Truth: y = 40 x is more than any isolator passes; y = 20 x is not."""
    assert judge(fresh(), 4.0, 0.1, count=200) == (LISTEN, False)
    assert judge(fresh(), 2.0, 0.1, count=200) == (ACT, True)


def test_an_error_that_has_grown_is_an_alarm_only_if_the_voltage_can_be_the_cause():
    """Truth: y = 4 x with r_0 = 1 and R = 3; alarm with an effect of 3, none with an effect of 0.5."""
    assert judge(heard(), 4.0, 1.0, effect=0.5, count=300)[0] == ACT
    backoff = heard()
    for _ in range(300):
        state = judge(backoff, 4.0, 1.0, effect=3.0)[0]
        if state != ACT:
            break
    assert state == FADE
    assert backoff.alarms == 1.0
    assert backoff.pace == 0.25


def test_an_alarm_fades_out_forgets_and_rings_down():
    """Truth: a tenth of the watch time of fading, RESTART once, then RING_DOWN at 0 V."""
    backoff = heard()
    while judge(backoff, 4.0, 1.0, effect=3.0)[0] != FADE:
        pass
    states = [judge(backoff, 4.0, 1.0, effect=3.0)[0] for _ in range(6)]
    assert states == [FADE] * 4 + [RESTART, RING_DOWN]
    assert backoff.share == 0.0


def test_it_tries_again_at_growing_intervals():
    """The error grows with the voltage, always.

    Truth: 10, 20, 40 watch times of 50 samples at 0 V, each ended by a new attempt.
    """
    backoff, waits, waiting = heard(), [], 0
    while len(waits) < 3:
        share = float(backoff.share)
        state = judge(backoff, 1.0 + 3.0 * share, 1.0, effect=3.0 * share)[0]
        if state == GIVEN_UP:
            waiting += 1
        elif waiting:
            waits.append(waiting)
            waiting = 0
    assert waits == [500, 1000, 2000]


def test_a_third_alarm_ends_it_and_success_takes_alarms_back():
    """The error grows with the voltage and goes with it.

    Truth: three alarms give up for 500 samples; 500 samples of success after one bring the count and the pace back; 200
    samples (four watch times) without any are the next alarm.
    """
    backoff = heard()
    for _ in range(2000):
        share = float(backoff.share)
        judge(backoff, 1.0 + 3.0 * share, 1.0, effect=3.0 * share)
        if backoff.alarms >= 3:
            break
    judge(backoff, 0.1, 1.0, count=10)
    assert judge(backoff, 0.1, 1.0, count=450)[0] == GIVEN_UP
    forgiven = heard()
    while judge(forgiven, 4.0, 1.0, effect=3.0)[0] != RESTART:
        pass
    judge(forgiven, 1.0, 1.0, count=50 + 50 + 100)
    assert forgiven.alarms == 1.0  # no alarm is not enough, it must do some good
    useless = deepcopy(forgiven)
    judge(useless, 1.0, 1.0, count=110)
    assert useless.alarms == 2.0
    judge(forgiven, 0.5, 1.0, count=50 + 520)
    assert forgiven.alarms == 0.0
    assert forgiven.pace == 1.0


def test_standing_at_the_limit_is_an_alarm():
    """Truth: more than a third of the samples cut, whatever the ratio says (x grows with y in a bad loop)."""
    backoff = heard()
    states = {judge(backoff, 1.0, 1.0, effect=1.0, cut=k % 2 == 0)[0] for k in range(200)}
    assert FADE in states
    backoff = heard()
    states = {judge(backoff, 1.0, 1.0, effect=1.0, cut=k % 5 == 0)[0] for k in range(400)}
    assert states == {ACT}


def test_bits_do_not_depend_on_the_batch():
    """Truth: item by item. Exact."""
    rng = np.random.default_rng(1)
    error, reference, effect = rng.standard_normal((3, 400, 2, 3)) * [
        [[[5.0]]],
        [[[1.0]]],
        [[[4.0]]],
    ]
    cut = rng.random((400, 2, 3)) < 0.3
    together = fresh((2, 3))
    for k in range(400):
        states, _ = together.step(error[k], reference[k], effect[k], cut[k], True, True)
    for i in np.ndindex(2, 3):
        alone = fresh()
        for k in range(400):
            state, _ = judge(alone, error[k][i], reference[k][i], effect[k][i], cut[k][i])
        assert state == states[i]
        for name in ('share', 'pace', 'alarms', 'passed'):
            assert getattr(alone, name) == getattr(together, name)[i]


def test_after_an_alarm_it_rings_down_first_and_less_is_an_alarm():
    """Truth: 50 samples in which even a loud y does not count, then r_0 = 1 from 50 quiet ones; y = 2 x, no alarm at
    first (R = 3), is one after the first (3^(1/2) = 1.73), and 1.6 x is not.
    """
    assert judge(heard(), 2.0, 1.0, effect=3.0, count=300)[0] == ACT
    backoff = heard()
    while judge(backoff, 4.0, 1.0, effect=3.0)[0] != RESTART:
        pass
    assert judge(backoff, 4.0, 1.0, count=50)[0] == RING_DOWN
    judge(backoff, 1.0, 1.0, count=100)
    assert backoff.passed == pytest.approx(1.0)
    # for less than the four watch times after which it would be useless
    assert judge(deepcopy(backoff), 1.6, 1.0, effect=3.0, count=150)[0] == ACT
    for _ in range(300):
        state = judge(backoff, 2.0, 1.0, effect=3.0)[0]
        if state != ACT:
            break
    assert state == FADE
    assert backoff.alarms == 2.0


def test_what_other_struts_shake_while_it_listens_again_is_no_measure_of_what_passes():
    """Truth: r_0 = 1 before the alarm; y = 3 x in the second listening does not count, y = x / 2 does."""
    for ratio, expected in ((3.0, 1.0), (0.5, 0.25)):
        backoff = heard()
        while judge(backoff, 4.0, 1.0, effect=3.0)[0] != RESTART:
            pass
        judge(backoff, ratio, 1.0, count=105)
        assert backoff.passed == pytest.approx(expected)
