# SPDX-FileCopyrightText: 2026 The satvib authors
# SPDX-License-Identifier: Apache-2.0
"""How a sample follows the one before: next, after a gap, repeated, or the first of a new run.

A node classifies each sample once, when it arrives, and hands the result on with the sample.
"""

from enum import Enum


class Arrival(Enum):
    """How a sample follows the one before."""

    FIRST = 'first'
    NEXT = 'next'
    GAP = 'gap'
    REPEAT = 'repeat'
    RESTART = 'restart'


class SequenceTracker:
    """Follows the `sequence` of one source.

    A sample that is older than the last one by at most `repeat_window` is a repeat, and is to be ignored. A sample that
    is older than that means that the source has started again.

    Attributes:
        last: the newest sequence, None before the first.
        lost, repeats, restarts: counts of samples that are missing, of repeats and of restarts.
    """

    def __init__(self, repeat_window: int = 100) -> None:
        self.repeat_window = repeat_window
        self.last: int | None = None
        self.lost = 0
        self.repeats = 0
        self.restarts = 0

    def classify(self, sequence: int) -> Arrival:
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
