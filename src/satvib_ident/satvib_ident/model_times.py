# SPDX-FileCopyrightText: 2026 The satvib authors
# SPDX-License-Identifier: Apache-2.0
"""After which samples a strut's identifier publishes its model, and when it has nothing more to hear.

In IDENTIFY that is every sample (Fig. 8 of the paper shows the parameters there). In the other phases in which it
estimates, that is the sample before a hand-over and the last one of the phase. In a phase in which it estimates nothing
the model does not change, and nothing is published: the last model stays in force. Each model names the next sample
after which there will be another, so that a controller knows whether to wait for it.
"""

from satvib_common.phases import Phase, PhasePlan

NEVER = 2**63 - 1  # no further model


class ModelTimes:
    """The samples of a plan after which there is a model.

    Args:
        plan: phases by sample.
        phases: those in which the estimate is updated.
        period: samples between hand-overs of the model.
    """

    def __init__(self, plan: PhasePlan, phases: frozenset[Phase], period: int) -> None:
        self.plan, self.phases, self.period = plan, phases, period
        # a plan without IDENTIFY has no hand-overs, so people see every model
        self._all = plan.first_of(Phase.IDENTIFY) is None

    def publishes(self, k: int) -> bool:
        """Whether a model is published after sample k."""
        plan = self.plan
        phase = plan.at(k)
        if phase not in self.phases:
            return False
        if self._all or phase is Phase.IDENTIFY or plan.is_hand_over(k + 1, self.period):
            return True
        return k + 1 == plan.end or plan.at(k + 1) not in self.phases

    def next_after(self, k: int) -> int:
        """The first sample after k after which a model is published; NEVER without one."""
        plan = self.plan
        for i in range(plan.index(k + 1), len(plan.phases)):
            if plan.phases[i] not in self.phases:
                continue
            start, stop = max(k + 1, plan.first[i]), self._stop(i)
            found = self._first_between(i, start, stop)
            if found is not None:
                return found
        return NEVER

    def is_over(self, k: int) -> bool:
        """Whether nothing is estimated after sample k."""
        later = self.plan.phases[self.plan.index(k + 1) :]
        return k + 1 == self.plan.end or not self.phases.intersection(later)

    def count(self) -> int:
        """How many models there are in the whole run."""
        return sum(self.publishes(k) for k in range(self.plan.end))

    def _stop(self, i: int) -> int | None:
        """First sample after phase i; None: it has no end."""
        plan = self.plan
        return plan.first[i + 1] if i + 1 < len(plan.first) else plan.end or None

    def _first_between(self, i: int, start: int, stop: int | None) -> int | None:
        if stop is not None and start >= stop:
            return None
        if self._all or self.plan.phases[i] is Phase.IDENTIFY:
            return start
        # hand-overs repeat with the period, so one period and the end of the phase are all there is to look at
        last = start + self.period if stop is None else min(start + self.period, stop - 1)
        near = (k for k in range(start, last + 1) if self.publishes(k))
        found = next(near, None)
        if found is None and stop is not None and self.publishes(stop - 1):
            return stop - 1
        return found
