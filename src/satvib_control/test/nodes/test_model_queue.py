# SPDX-FileCopyrightText: 2026 The satvib authors
# SPDX-License-Identifier: Apache-2.0
"""The queue of models before their hand-over sample."""

from hypothesis import given
from hypothesis import strategies as st
from satvib_common.phases import Phase, PhasePlan
from satvib_control.nodes.model_queue import ModelQueue
from satvib_ident.model_times import ModelTimes

PLAN = PhasePlan(
    (Phase.CALIBRATE, Phase.IDENTIFY, Phase.ADAPT, Phase.CONTROL), (0, 10, 40, 60), 200
)
PERIOD = 7


def published(k):
    """The samples after which an identifier publishes that says nothing of the next one."""
    return PLAN.at(k) == Phase.IDENTIFY or PLAN.is_hand_over(k + 1, PERIOD)


@given(st.randoms(use_true_random=False))
def test_in_lockstep_every_delay_gives_the_same_models(random):
    """Truth: the plan. At each hand-over sample exactly the model of the sample before, however late it comes."""
    queue = ModelQueue(PERIOD, wait=True)
    queue.begin(0)
    waiting, taken = [], {}
    k = 0
    while k < PLAN.end:
        if waiting and random.random() > 0.6:
            model = waiting.pop(0)
            queue.add(model, model, PLAN)
        ready, model = queue.take(k, PLAN)
        if not ready:
            newest = waiting.pop(0)
            queue.add(newest, newest, PLAN)
            continue
        if model is not None:
            taken[k] = model
        if published(k):
            waiting.append(k)
        k += 1
    assert taken == {k: k - 1 for k in range(PLAN.end) if PLAN.is_hand_over(k, PERIOD)}


@given(st.randoms(use_true_random=False))
def test_a_model_in_force_is_not_waited_for(random):
    """Truth: the plan, and `ModelTimes`: after IDENTIFY no model comes, and the last one is taken once."""
    times = ModelTimes(PLAN, frozenset({Phase.IDENTIFY}), PERIOD)
    queue = ModelQueue(PERIOD, wait=True)
    queue.begin(0)
    waiting, taken = [], {}
    k = 0
    while k < PLAN.end:
        ready = not waiting or random.random() <= 0.6
        if not ready:
            model = waiting.pop(0)
            queue.add(model, model, PLAN, times.next_after(model))
        ready, model = queue.take(k, PLAN)
        if not ready:
            newest = waiting.pop(0)
            queue.add(newest, newest, PLAN, times.next_after(newest))
            continue
        if model is not None:
            taken[k] = model
        if times.publishes(k):
            waiting.append(k)
        k += 1
    # 17, 24, 31 and 38 in IDENTIFY, and the first sample of ADAPT
    assert taken == {17: 16, 24: 23, 31: 30, 38: 37, 40: 39}


def test_in_real_time_the_newest_is_taken_and_nobody_waits():
    """Truth: by hand. Sample 17 is a hand-over; the model of 16 is late."""
    queue = ModelQueue(PERIOD, wait=False)
    queue.begin(0)
    for k in (10, 11, 12):
        queue.add(k, k, PLAN)
    assert queue.take(16, PLAN) == (True, None)
    assert queue.take(17, PLAN) == (True, 12)
    assert queue.take(24, PLAN) == (True, None)


def test_a_late_joiner_takes_the_newest_once():
    """Truth: by hand. The first sample it sees is 100, between two hand-overs."""
    queue = ModelQueue(PERIOD, wait=True)
    for k in (50, 65, 93):
        queue.add(k, k, PLAN)
    queue.begin(100)
    assert queue.take(100, PLAN) == (True, 93)
    assert queue.take(102, PLAN) == (True, None)


def test_a_newer_model_proves_that_the_one_before_is_lost():
    """Truth: the topic is in order; without this rule a joiner would wait for ever."""
    queue = ModelQueue(PERIOD, wait=True)
    queue.begin(0)
    queue.add(20, 20, PLAN)
    assert queue.take(17, PLAN) == (True, None)


def test_the_queue_stays_short():
    """Truth: only models that will be asked for, and the newest, are kept."""
    queue = ModelQueue(PERIOD, wait=True)
    queue.begin(0)
    queue.take(0, PLAN)
    for k in range(10, 40):
        queue.add(k, k, PLAN)
    assert len(queue._models) <= 30 // PERIOD + 2


def test_models_ahead_of_the_first_sample_are_kept():
    """Truth: a controller that was started again gets the past of both topics, in any order."""
    queue = ModelQueue(PERIOD, wait=True)
    for k in range(10, 40):
        queue.add(k, k, PLAN)
    queue.begin(0)
    taken = {}
    for k in range(40):
        ready, model = queue.take(k, PLAN)
        assert ready
        if model is not None:
            taken[k] = model
    assert taken == {17: 16, 24: 23, 31: 30, 38: 37}


def test_another_run_forgets_the_models_of_the_one_before():
    """Truth: by hand; whichever of the two streams begins the new run first."""
    for model_first in (False, True):
        queue = ModelQueue(PERIOD, wait=True)
        queue.begin(0)
        for k in (50, 51, 52):
            queue.add(k, f'old {k}', PLAN)
        if model_first:
            queue.add(16, 'new 16', PLAN)
            queue.begin(0, new_run=True)
        else:
            queue.begin(0, new_run=True)
            queue.add(16, 'new 16', PLAN)
        assert queue.take(17, PLAN) == (True, 'new 16')
