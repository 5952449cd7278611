# SPDX-FileCopyrightText: 2026 The satvib authors
# SPDX-License-Identifier: Apache-2.0
"""What arrives out of step: gaps, repeats and restarts of the sample index."""

from enum import Enum


class Arrival(Enum):
    """How a sample stands to the one before."""

    FIRST = 'first'
    NEXT = 'next'
    GAP = 'gap'
    REPEAT = 'repeat'
    RESTART = 'restart'


class SequenceTracker:
    """Follows the `sequence` of one source.

    A sample that is older by no more than `repeat_window` is a repeat, to be ignored; one that is older than that means
    that the source has started anew.
    """

    def __init__(self, repeat_window: int = 100) -> None:
        self.repeat_window = repeat_window
        self.last: int | None = None
        self.lost = 0
        self.repeats = 0
        self.restarts = 0

    def see(self, sequence: int) -> Arrival:
        """Classify a sample and count it."""
        last, self.last = self.last, sequence
        if last is None:
            return Arrival.FIRST
        if sequence == last + 1:
            return Arrival.NEXT
        if sequence > last:
            self.lost += sequence - last - 1
            return Arrival.GAP
        if sequence > 0 and last - sequence <= self.repeat_window:
            self.last = last
            self.repeats += 1
            return Arrival.REPEAT
        self.restarts += 1
        return Arrival.RESTART
