# SPDX-FileCopyrightText: 2026 The satvib authors
# SPDX-License-Identifier: Apache-2.0
"""After which samples there is a model."""

import pytest
from hypothesis import given
from hypothesis import strategies as st
from satvib_common.phases import Phase, PhasePlan
from satvib_ident.model_times import NEVER, ModelTimes

PLAN = PhasePlan(
    (Phase.CALIBRATE, Phase.IDENTIFY, Phase.ADAPT, Phase.CONTROL), (0, 10, 40, 60), 200
)
IDENTIFY = frozenset({Phase.IDENTIFY})


def test_by_default_every_sample_of_identify_and_no_other():
    """Truth: Fig. 8 of the paper shows the parameters over IDENTIFY; afterwards the model does not change."""
    times = ModelTimes(PLAN, IDENTIFY, 7)
    assert [k for k in range(200) if times.publishes(k)] == list(range(10, 40))
    assert times.count() == 30
    assert times.next_after(-1) == times.next_after(9) == 10
    assert times.next_after(38) == 39
    assert times.next_after(39) == times.next_after(150) == NEVER
    assert [times.is_over(k) for k in (0, 38, 39, 199)] == [False, False, True, True]


def test_where_it_goes_on_estimating_the_samples_before_a_hand_over():
    """Truth: by hand; hand-overs are at 10 + 7 i and at 40 and 60, and the last sample shows the last model."""
    times = ModelTimes(PLAN, IDENTIFY | {Phase.CONTROL}, 7)
    after = [k for k in range(40, 200) if times.publishes(k)]
    assert after == [k for k in range(60, 200) if (k + 1 - 10) % 7 == 0 or k == 199]
    assert not times.is_over(150)
    assert times.is_over(199)


def test_a_plan_without_hand_overs_shows_every_model():
    """Truth: the rule; people would otherwise see nothing of such a run."""
    times = ModelTimes(PhasePlan((Phase.CONTROL,), (0,)), frozenset({Phase.CONTROL}), 50)
    assert times.publishes(12345)
    assert times.next_after(12345) == 12346
    assert not times.is_over(10**9)


PHASES = st.lists(st.sampled_from(list(Phase)), min_size=1, max_size=5)


@given(PHASES, st.sets(st.sampled_from(list(Phase))), st.integers(0, 9), st.data())
def test_next_after_names_the_next_one(phases, estimated, period, data):
    """Truth: `publishes`, asked sample by sample."""
    first = [0]
    for _ in phases[1:]:
        first.append(first[-1] + data.draw(st.integers(1, 20)))
    end = first[-1] + data.draw(st.integers(1, 20))
    plan = PhasePlan(tuple(phases), tuple(first), end)
    times = ModelTimes(plan, frozenset(estimated), period)
    for k in range(-1, end - 1):
        expected = next((j for j in range(k + 1, end) if times.publishes(j)), NEVER)
        assert times.next_after(k) == expected
    last = max((k for k in range(end) if plan.at(k) in estimated), default=-1)
    assert [k for k in range(end) if times.is_over(k)] == [k for k in range(end) if k >= last]


@pytest.mark.parametrize('period', [0, 7])
def test_a_phase_without_end(period):
    """Truth: by hand; without a period and without an end no further model is due."""
    plan = PhasePlan((Phase.IDENTIFY, Phase.CONTROL), (0, 30))
    times = ModelTimes(plan, frozenset({Phase.IDENTIFY, Phase.CONTROL}), period)
    assert times.next_after(29) == (34 if period else NEVER)
