# SPDX-FileCopyrightText: 2026 The satvib authors
# SPDX-License-Identifier: Apache-2.0
"""The models that wait for their hand-over sample.

At hand-over sample k (see `PhasePlan.is_hand_over`) a controller takes the model that is in force after sample k - 1.
In lockstep it waits for that very model, so that no timing changes a bit; otherwise it takes the newest that is there.
A model says until when it is in force, and one that has been taken is not taken again. A controller that joins a run at
a later sample takes the newest model once, because the hand-overs before it are gone.
"""

from collections import deque
from typing import Generic, TypeVar

from satvib_common.phases import PhasePlan

M = TypeVar('M')


class ModelQueue(Generic[M]):
    """Models by the sample that they include last.

    Args:
        period: samples between hand-overs.
        wait: take the model of the sample before and no other.
    """

    def __init__(self, period: int, wait: bool) -> None:
        self.period, self.wait = period, wait
        # sequence, the sample after which the next one comes, and the model
        self._models: deque[tuple[int, int, M]] = deque()
        self._in_force_until = 0  # the model that was taken last
        self._joined = False
        # how often each stream has begun a new run; either may be the first to do so
        self._model_restarts = self._sample_restarts = 0

    def add(self, sequence: int, model: M, plan: PhasePlan | None, next_sequence: int = 0) -> None:
        """Keep a model: those that will be asked for, and the newest.

        Args:
            sequence: the sample that it includes last.
            model: it.
            plan: phases by sample, when they are known.
            next_sequence: the sample after which the next one comes; 0: the very next.
        """
        if self._models and sequence <= self._models[-1][0]:
            self._models.clear()  # the identifier began a new run
            self._in_force_until = 0
            self._model_restarts += 1
        if self._models and self._joined and plan is not None:
            last = self._models[-1][0]
            if not plan.has_hand_over(last + 1, sequence, self.period):
                self._models.pop()
        self._models.append((sequence, max(next_sequence, sequence + 1), model))

    def begin(self, sequence: int, new_run: bool = False) -> None:
        """Take the number of the first sample; `new_run`: of another run than the samples before.

        Models that came before the first sample are kept, because topics arrive in any order.
        """
        self._joined = sequence == 0
        if new_run:
            self._sample_restarts += 1
            if self._model_restarts < self._sample_restarts:
                self._models.clear()
                self._in_force_until = 0
                self._model_restarts = self._sample_restarts

    @property
    def newest(self) -> int:
        """The sample that the newest model includes last; -1: no model waits."""
        return self._models[-1][0] if self._models else -1

    def take(self, k: int, plan: PhasePlan) -> tuple[bool, M | None]:
        """Give whether sample k has all it needs, and the model that it takes, if any."""
        due = plan.is_hand_over(k, self.period)
        if self._joined and not due:
            return True, None
        newest: tuple[int, int, M] | None = None
        while self._models and self._models[0][0] < k:
            newest = self._models.popleft()
        # a newer model in the queue proves that the one of k - 1 will not come
        gone = not self._joined or bool(self._models)
        self._joined = True
        until = self._in_force_until if newest is None else newest[1]
        if self.wait and not gone and until < k:
            if newest is not None:
                self._models.appendleft(newest)
            return False, None
        self._in_force_until = until
        return True, None if newest is None else newest[2]
