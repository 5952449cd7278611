# SPDX-FileCopyrightText: 2026 The satvib authors
# SPDX-License-Identifier: Apache-2.0
"""A sample clock of the host, for devices that have none: absolute times, counted from the start."""

import math


class Ticker:
    """Ticks at `start` + k `period`.

    A tick that is missed by a period or more is lost: the host cannot sample the past. The index shows the gap.

    Attributes:
        lost: ticks so far that were missed.
    """

    def __init__(self, period: float) -> None:
        self.period = period
        self.lost = 0
        self._start = math.inf
        self._next = 0

    def start(self, now: float) -> None:
        """Set tick 0 to one period from now."""
        self._start = now + self.period
        self._next = 0

    def due(self) -> float:
        """When the next tick is, s."""
        return self._start + self._next * self.period

    def take(self, now: float) -> tuple[int, float] | None:
        """Give the index and the time of the tick that is due, None when none is."""
        if now < self.due():
            return None
        index = max(self._next, math.floor((now - self._start) / self.period + 1e-9))
        self.lost += index - self._next
        self._next = index + 1
        return index, self._start + index * self.period
