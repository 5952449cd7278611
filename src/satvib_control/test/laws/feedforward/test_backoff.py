# SPDX-FileCopyrightText: 2026 The satvib authors
# SPDX-License-Identifier: Apache-2.0
"""When feedforward may learn and act: the judge alone, sample by sample."""

import numpy as np
import pytest
from satvib_control.laws.feedforward.backoff import (
    BASE,
    COUNT,
    FADE,
    GIVEN_UP,
    LEARN,
    LISTEN,
    PACE,
    RESTART,
    SHARE,
    SIZE,
    watch,
)

WINDOW = 50.0


def fresh(shape=()):
    memory = np.zeros((*shape, SIZE))
    memory[..., PACE] = 1.0
    return memory


def judge(memory, error, reference, effect=0.0, cut=False, valid=True, acting=True, count=1):
    for _ in range(count):
        verdict, loud = watch(
            error, reference, effect, cut, valid, acting, np.array([WINDOW, 3.0, 0.02]), memory
        )
    return int(verdict), bool(loud)


def heard(ratio=1.0):
    """A memory that has listened, with y / x = ratio, and has let its voltage in."""
    memory = fresh()
    judge(memory, ratio, 1.0, count=150)
    assert memory[SHARE] == 1.0
    return memory


def test_it_listens_for_a_watch_time_and_lets_the_voltage_in_over_half_of_one():
    """Truth: 50 samples of listening, learning from the 38th on, r_0 = 0.25, then 25 of fading in."""
    memory = fresh()
    assert judge(memory, 0.5, 1.0, count=37) == (LISTEN, False)
    assert judge(memory, 0.5, 1.0, count=12) == (LISTEN, True)
    assert memory[SHARE] == 0.0
    judge(memory, 0.5, 1.0)
    assert memory[BASE] == pytest.approx(0.25)
    assert judge(memory, 0.5, 1.0, count=5) == (LEARN, True)
    assert memory[SHARE] == pytest.approx(5 / 25)
    judge(memory, 0.5, 1.0, count=30)
    assert memory[SHARE] == 1.0


def test_silence_teaches_nothing():
    """Truth: below the floor it listens for ever."""
    memory = fresh()
    assert judge(memory, 0.01, 0.01, count=1000) == (LISTEN, False)


def test_a_payload_that_rings_is_not_a_reference():
    """Truth: y = 40 x is more than any isolator passes; y = 20 x is not."""
    assert judge(fresh(), 4.0, 0.1, count=200) == (LISTEN, False)
    assert judge(fresh(), 2.0, 0.1, count=200) == (LEARN, True)


def test_an_error_that_has_grown_is_an_alarm_only_if_the_voltage_can_be_the_cause():
    """Truth: y = 4 x with r_0 = 1 and R = 3; alarm with an effect of 3, none with an effect of 0.5."""
    assert judge(heard(), 4.0, 1.0, effect=0.5, count=300)[0] == LEARN
    memory = heard()
    for _ in range(300):
        verdict = judge(memory, 4.0, 1.0, effect=3.0)[0]
        if verdict != LEARN:
            break
    assert verdict == FADE
    assert memory[COUNT] == 1.0
    assert memory[PACE] == 0.25


def test_an_alarm_fades_out_forgets_and_listens_anew():
    """Truth: a tenth of the watch time of fading, RESTART once, then LISTEN at 0."""
    memory = heard()
    while judge(memory, 4.0, 1.0, effect=3.0)[0] != FADE:
        pass
    verdicts = [judge(memory, 4.0, 1.0, effect=3.0)[0] for _ in range(6)]
    assert verdicts == [FADE] * 4 + [RESTART, LISTEN]
    assert memory[SHARE] == 0.0


def test_a_third_alarm_ends_it_and_peace_forgives():
    """The error grows with the voltage and goes with it.

    Truth: three alarms give up for good; 500 samples of success after one bring the count and the pace back; 200
    samples (four watch times) without any are the next alarm.
    """
    memory = heard()
    for _ in range(2000):
        share = float(memory[SHARE])
        judge(memory, 1.0 + 3.0 * share, 1.0, effect=3.0 * share)
        if memory[COUNT] >= 3:
            break
    judge(memory, 0.1, 1.0, count=10)
    assert judge(memory, 0.1, 1.0, count=5000)[0] == GIVEN_UP
    forgiven = heard()
    while judge(forgiven, 4.0, 1.0, effect=3.0)[0] != RESTART:
        pass
    judge(forgiven, 1.0, 1.0, count=50 + 50 + 100)
    assert forgiven[COUNT] == 1.0  # peace is not enough, it must do some good
    useless = forgiven.copy()
    judge(useless, 1.0, 1.0, count=110)
    assert useless[COUNT] == 2.0
    judge(forgiven, 0.5, 1.0, count=50 + 520)
    assert forgiven[COUNT] == 0.0
    assert forgiven[PACE] == 1.0


def test_standing_at_the_limit_is_an_alarm():
    """Truth: more than a third of the samples cut, whatever the ratio says (x grows with y in a bad loop)."""
    memory = heard()
    verdicts = {judge(memory, 1.0, 1.0, effect=1.0, cut=k % 2 == 0)[0] for k in range(200)}
    assert FADE in verdicts
    memory = heard()
    verdicts = {judge(memory, 1.0, 1.0, effect=1.0, cut=k % 5 == 0)[0] for k in range(400)}
    assert verdicts == {LEARN}


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
        watch(
            error[k], reference[k], effect[k], cut[k], True, True,
            np.array([WINDOW, 3.0, 0.02]), together,
        )  # fmt: skip
    for i in np.ndindex(2, 3):
        alone = fresh()
        for k in range(400):
            judge(alone, error[k][i], reference[k][i], effect[k][i], cut[k][i])
        assert np.array_equal(alone, together[i])


def test_a_law_that_has_failed_rings_down_first_and_is_believed_less():
    """Truth: 50 samples in which even a loud y is not heard, then r_0 = 1 from 50 quiet ones; y = 2 x, no alarm at
    first (R = 3), is one after the first (3^(1/2) = 1.73), and 1.6 x is not.
    """
    assert judge(heard(), 2.0, 1.0, effect=3.0, count=300)[0] == LEARN
    memory = heard()
    while judge(memory, 4.0, 1.0, effect=3.0)[0] != RESTART:
        pass
    assert judge(memory, 4.0, 1.0, count=50)[0] == LISTEN
    judge(memory, 1.0, 1.0, count=100)
    assert memory[BASE] == pytest.approx(1.0)
    # for less than the four watch times after which it would be useless
    assert judge(memory.copy(), 1.6, 1.0, effect=3.0, count=150)[0] == LEARN
    for _ in range(300):
        verdict = judge(memory, 2.0, 1.0, effect=3.0)[0]
        if verdict != LEARN:
            break
    assert verdict == FADE
    assert memory[COUNT] == 2.0


def test_what_other_struts_shake_while_it_listens_anew_is_no_measure_of_what_passes():
    """Truth: r_0 = 1 before the alarm; y = 3 x in the second listening is not believed, y = x / 2 is."""
    for ratio, believed in ((3.0, 1.0), (0.5, 0.25)):
        memory = heard()
        while judge(memory, 4.0, 1.0, effect=3.0)[0] != RESTART:
            pass
        judge(memory, ratio, 1.0, count=105)
        assert memory[BASE] == pytest.approx(believed)
