# SPDX-FileCopyrightText: 2026 The satvib authors
# SPDX-License-Identifier: Apache-2.0
"""The guard, the phase plan and the sequence tracker. Truth: the rules stated in their docstrings."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from satvib_common.errors import SatvibError
from satvib_common.guard import VoltageGuard
from satvib_common.phases import Phase, PhasePlan
from satvib_common.sequence import Arrival, SequenceTracker

any_float = st.floats(allow_nan=True, allow_infinity=True)


@given(st.lists(st.tuples(any_float, st.booleans()), min_size=1, max_size=60))
def test_whatever_is_asked_the_voltage_stays_lawful(demands):
    """Never beyond the limit, never faster than the slew limit except to 0 V, 0 V for ever after a fault."""
    guard = VoltageGuard(20.0, 500.0, 0.01, (2,))
    before, faulted = np.zeros(2), False
    for demand, stop in demands:
        out = guard.apply(np.array([demand, 1.0]), np.array([stop, False]))
        faulted |= stop or not np.isfinite(demand)
        assert np.all(np.isfinite(out.voltage))
        assert np.all(np.abs(out.voltage) <= 20.0)
        assert np.all((np.abs(out.voltage - before) <= 5.0 * (1 + 1e-12)) | (out.voltage == 0.0))
        assert bool(out.fault[0]) is faulted
        assert not faulted or out.voltage[0] == 0.0
        assert not out.fault[1]
        before = out.voltage


def test_reset_releases_only_where_asked():
    guard = VoltageGuard(20.0, np.inf, 0.01, (2,))
    guard.apply(np.array([np.nan, np.nan]))
    guard.reset(np.array([True, False]))
    out = guard.apply(np.array([3.0, 3.0]))
    np.testing.assert_array_equal(out.voltage, [3.0, 0.0])
    np.testing.assert_array_equal(out.fault, [False, True])


def test_saturation_is_told():
    guard = VoltageGuard(2.0, np.inf, 0.01)
    assert guard.apply(np.asarray(5.0)).saturated
    assert not guard.apply(np.asarray(1.0)).saturated


PAPER = PhasePlan.from_seconds(
    [
        (Phase.CALIBRATE, 0.0),
        (Phase.IDENTIFY, 1.0),
        (Phase.ADAPT, 3.0),
        (Phase.STANDBY, 5.0),
        (Phase.CONTROL, 10.0),
    ],
    25.0,
    100.0,
)


def test_phases_of_the_paper():
    """Truth: the times of the paper's experiment at 100 Hz."""
    assert [PAPER.at(k) for k in (0, 99, 100, 299, 300, 500, 999, 1000, 2499)] == [
        Phase.CALIBRATE, Phase.CALIBRATE, Phase.IDENTIFY, Phase.IDENTIFY, Phase.ADAPT,
        Phase.STANDBY, Phase.STANDBY, Phase.CONTROL, Phase.CONTROL,
    ]  # fmt: skip
    assert PAPER.start_of(450) == 300
    assert PAPER.first_of(Phase.CONTROL) == 1000
    assert PAPER.end == 2500


def test_handover_samples():
    """Truth: the definition: phase changes to ADAPT and CONTROL, and every period after IDENTIFY began."""
    assert [k for k in range(2500) if PAPER.is_hand_over(k, 0)] == [300, 1000]
    assert [k for k in range(420) if PAPER.is_hand_over(k, 100)] == [200, 300, 400]
    bare = PhasePlan((Phase.STANDBY, Phase.CONTROL), (0, 10))
    assert not any(bare.is_hand_over(k, 5) for k in range(100))


@pytest.mark.parametrize(
    ('phases', 'first', 'end', 'message'),
    [
        ((), (), 0, '0 phases'),
        ((Phase.STANDBY,), (5,), 0, 'begins at sample 5'),
        ((Phase.STANDBY, Phase.CONTROL), (0, 0), 0, 'begins at 0, not after 0'),
        ((Phase.STANDBY, Phase.CONTROL), (0, 9), 9, 'ends at 9'),
    ],
)
def test_a_plan_out_of_order_is_refused(phases, first, end, message):
    with pytest.raises(SatvibError, match=message):
        PhasePlan(phases, first, end)


@pytest.mark.parametrize(
    ('sequences', 'expected'),
    [
        # one old and one far message change nothing
        ([500, 3, 501, 10**6, 502, 0, 503], 'first stray next stray next stray next'),
        # the second sample of a new run proves it; so does the second after a long gap
        ([500, 0, 1, 2], 'first stray restart next'),
        ([500, 900, 901, 902], 'first stray gap next'),
        # two strays that do not follow each other prove nothing
        ([500, 3, 390, 10, 501], 'first stray stray stray next'),
        # short gaps and repeats are what they were
        ([500, 503, 502, 504], 'first gap repeat next'),
    ],
)
def test_one_message_alone_proves_no_new_run(sequences, expected):
    """Truth: the rule of the docstring, with the window of 100 samples."""
    tracker = SequenceTracker(confirm=True)
    assert [tracker.classify(k).value for k in sequences] == expected.split()


def test_in_lockstep_sample_0_begins_a_new_run_at_once():
    tracker = SequenceTracker(confirm=True, zero_restarts=True)
    found = [tracker.classify(k).value for k in (500, 3, 501, 0, 1)]
    assert found == ['first', 'stray', 'next', 'restart', 'next']


def test_a_source_that_follows_the_clock_is_not_ahead_of_it():
    """Truth: by hand. A stranger counts on from 10^9, five samples between two of the source: it is never followed.

    After 100 s of silence, which are 20000 samples, the source itself may be there. Without a clock, or in lockstep,
    two samples that follow each other are enough.
    """
    time = 0.0
    tracker = SequenceTracker(confirm=True)
    tracker.follow(lambda: 200.0 * time)
    found, far = [], 10**9
    for k in range(40):
        time = k / 200.0
        found.append(tracker.classify(k).value)
        for _ in range(5):
            far += 1
            found.append(tracker.classify(far).value)
    assert found == ['first', *['stray'] * 5, *(['next'] + ['stray'] * 5) * 39]
    # the source has ended, and the stranger is all there is: it is followed, and so is the next one, which goes back
    seen = [tracker.classify(far + k).value for k in range(1, 102)]
    assert seen == [*['stray'] * 94, 'gap', *['next'] * 6]
    far += 101
    seen = [tracker.classify(k).value for k in range(60, 72)]
    assert seen == [*['stray'] * 9, 'restart', 'next', 'next']
    time += 100.0
    assert [tracker.classify(k).value for k in (20030, 20031, 20032)] == ['stray', 'gap', 'next']
    assert tracker.classify(2 * 10**9).value == 'stray'
    tracker.follow(None)
    assert [tracker.classify(far + k).value for k in range(3)] == ['stray', 'gap', 'next']


def test_a_source_that_is_heard_late_may_catch_up():
    """Truth: by hand. A reader joins when 1000 samples wait; they come at once, and a gap among them is no stray."""
    tracker = SequenceTracker(confirm=True)
    tracker.follow(lambda: 0.0)
    found = [tracker.classify(k).value for k in (5000, 5001, 5900, 5901, 6000)]
    assert found == ['first', 'next', 'stray', 'gap', 'gap']


@given(
    st.lists(st.integers(1, 40), min_size=4, max_size=4), st.integers(0, 150), st.integers(-5, 60),
    st.integers(0, 12),
)  # fmt: skip
def test_whether_samples_have_a_hand_over(lengths, first, count, period):
    """Truth: `is_hand_over` of each of them."""
    begins = np.cumsum([0, *lengths])
    phases = (Phase.STANDBY, Phase.IDENTIFY, Phase.ADAPT, Phase.IDENTIFY, Phase.CONTROL)
    plan = PhasePlan(phases, tuple(map(int, begins)))
    there = any(plan.is_hand_over(k, period) for k in range(first, first + count + 1))
    assert plan.has_hand_over(first, first + count, period) == there
    assert plan.has_hand_over(first, 2**64, 1)


def test_sequence_tracker():
    tracker = SequenceTracker()
    seen = [tracker.classify(k) for k in (5, 6, 9, 9, 8, 10, 0, 1)]
    assert seen == [
        Arrival.FIRST, Arrival.NEXT, Arrival.GAP, Arrival.REPEAT, Arrival.REPEAT, Arrival.NEXT,
        Arrival.RESTART, Arrival.NEXT,
    ]  # fmt: skip
    assert (tracker.lost, tracker.repeats, tracker.restarts) == (2, 2, 1)
