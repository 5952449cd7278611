# SPDX-FileCopyrightText: 2026 The satvib authors
# SPDX-License-Identifier: Apache-2.0
"""How a sample follows the one before: next, after a gap, repeated, the first of a new run, or a stray.

A node classifies each sample once, when it arrives, and hands the result on with the sample.
"""

from collections.abc import Callable
from enum import Enum

# samples by which a source may be ahead of where the clock and its first one put it: they waited for the reader then
_BACKLOG = 1100
_DRIFT = 1.01  # of two clocks, far above that of any quartz
# samples in a row, with none of the source before, that prove another run or a gap. One that goes back, or is ahead of
# the clock, is most often a second source; to go back must cost less than what `Rivals` takes for two.
_PROOF, _PROOF_BACK, _PROOF_AHEAD = 2, 10, 100


class Arrival(Enum):
    """How a sample follows the one before."""

    FIRST = 'first'
    NEXT = 'next'
    GAP = 'gap'
    REPEAT = 'repeat'
    RESTART = 'restart'
    STRAY = 'stray'


class SequenceTracker:
    """Follows the `sequence` of one source.

    A sample that is older than the last one by at most `repeat_window` is a repeat, and is to be ignored. A sample that
    is older than that means that the source has started again.

    With `confirm` one sample alone proves neither a new run nor a gap of more than `repeat_window`: it is a stray, and
    to be ignored, until a second one follows it. One late or foreign message then costs nothing, and a true restart
    costs one sample. In lockstep that one sample would never be answered, and a run begins with sample 0: there
    `zero_restarts` takes sample 0 at once.

    A source that follows a clock (`follow`) does not go back, and cannot be further than the clock. With `confirm` such
    samples are strays until 10 of them that go back, or 100 that are ahead, have come in a row and none of the source
    between them: then that one has ended.

    Args:
        repeat_window: samples.
        confirm: wait for a second sample before a restart or a long gap.
        zero_restarts: except for sample 0.

    Attributes:
        zero_restarts: may be changed.
        last: the newest sequence, None before the first.
        lost, repeats, restarts, strays: counts of samples that are missing, of repeats, restarts and strays.
    """

    def __init__(
        self, repeat_window: int = 100, *, confirm: bool = False, zero_restarts: bool = False
    ) -> None:
        self.repeat_window = repeat_window
        self._confirm, self.zero_restarts = confirm, zero_restarts
        self._candidate: int | None = None
        self._now: Callable[[], float] | None = None
        self._begun: tuple[int, float] | None = None  # a sample, and when it came by that clock
        self._row = 0  # strays that follow each other
        self.strays = 0
        self.last: int | None = None
        self.lost = 0
        self.repeats = 0
        self.restarts = 0

    def follow(self, now: Callable[[], float] | None) -> None:
        """Hold the source to a clock: `now` gives its time, in sample periods; None: it follows none."""
        self._now, self._begun = now, None

    def classify(self, sequence: int) -> Arrival:
        """Classify a sample and count it."""
        arrival = self._classify(sequence)
        if self._now is not None and arrival is not Arrival.STRAY:
            begins = self._begun is None and arrival is Arrival.NEXT
            if begins or self._row or arrival in {Arrival.FIRST, Arrival.RESTART}:
                self._begun = sequence, self._now()
        if arrival is not Arrival.STRAY:
            self._candidate, self._row = None, 0
        return arrival

    def _classify(self, sequence: int) -> Arrival:
        last, self.last = self.last, sequence
        if last is None:
            return Arrival.FIRST
        if sequence == last + 1:
            return Arrival.NEXT
        if self._confirm and self._is_stray(sequence, last):
            self.last = last
            self.strays += 1
            return Arrival.STRAY
        if sequence > last:
            self.lost += sequence - last - 1
            return Arrival.GAP
        if sequence > 0 and last - sequence <= self.repeat_window:
            self.last = last
            self.repeats += 1
            return Arrival.REPEAT
        self.restarts += 1
        return Arrival.RESTART

    def _is_stray(self, sequence: int, last: int) -> bool:
        """Whether a sample that is far from the last one has too few before it that it follows."""
        near = abs(sequence - last) <= self.repeat_window and sequence > 0
        if near or (sequence == 0 and self.zero_restarts):
            return False
        candidate, self._candidate = self._candidate, sequence
        follows = candidate is not None and 0 < sequence - candidate <= self.repeat_window
        self._row = self._row + 1 if follows else 1
        return self._row < self._proof(sequence, last)

    def _proof(self, sequence: int, last: int) -> int:
        """How many samples in a row prove another run or a gap."""
        if self._now is None:
            return _PROOF
        if sequence < last:
            return _PROOF_BACK
        return _PROOF_AHEAD if self._is_out_of_reach(sequence) else _PROOF

    def _is_out_of_reach(self, sequence: int) -> bool:
        """Whether a source that follows the clock cannot be there yet."""
        if self._now is None or self._begun is None:
            return False
        first, then = self._begun
        return sequence - first > _DRIFT * (self._now() - then) + _BACKLOG


class Rivals:
    """Whether two sources speak on one topic, from the order of their messages alone.

    A single source repeats a message or starts again now and then. Two of them do so with every message.

    Attributes:
        found: it is so; until `reset`.
    """

    _LIMIT, _FORGIVEN = 20.0, 0.1

    def __init__(self) -> None:
        self.found = False
        self._level = 0.0

    def saw(self, odd: bool) -> bool:
        """Take a message, and whether it repeats or goes back; gives whether it has just become clear."""
        if not odd:
            self._level = max(self._level - self._FORGIVEN, 0.0)
            return False
        self._level += 1.0
        news = self._level >= self._LIMIT and not self.found
        self.found = self.found or news
        return news

    def reset(self) -> None:
        """Begin again."""
        self.found, self._level = False, 0.0
