# SPDX-FileCopyrightText: 2026 The satvib authors
# SPDX-License-Identifier: Apache-2.0
"""The phases of an experiment, as a function of the sample index alone."""

from bisect import bisect_right
from collections.abc import Sequence
from dataclasses import dataclass
from enum import IntEnum
from functools import cached_property

from satvib_common.errors import SatvibError

_MOST_SAMPLES = 2.0**53  # above, a float does not hold every whole number


class Phase(IntEnum):
    """What a strut does; the numbers are those of satvib_msgs/Schedule."""

    STANDBY = 0
    CALIBRATE = 1
    IDENTIFY = 2
    ADAPT = 3
    CONTROL = 4


@dataclass(frozen=True)
class PhasePlan:
    """Phases by first sample.

    Attributes:
        phases: the phases in order.
        first: first `sequence` of each, strictly increasing, beginning with 0.
        end: number of samples of the experiment; 0 means without end.
    """

    phases: tuple[Phase, ...]
    first: tuple[int, ...]
    end: int = 0

    def __post_init__(self) -> None:
        """Check the order of the phases."""
        if not self.phases or len(self.phases) != len(self.first):
            raise SatvibError(
                f'schedule: {len(self.phases)} phases but {len(self.first)} first samples'
            )
        if self.first[0] != 0:
            raise SatvibError(f'schedule: the first phase begins at sample {self.first[0]}, not 0')
        for before, after in zip(self.first, self.first[1:], strict=False):
            if after <= before:
                raise SatvibError(f'schedule: a phase begins at {after}, not after {before}')
        if self.end and self.end <= self.first[-1]:
            raise SatvibError(f'schedule: ends at {self.end}, in or before its last phase')

    @classmethod
    def from_seconds(
        cls, steps: Sequence[tuple[Phase, float]], duration: float, rate: float
    ) -> 'PhasePlan':
        """Make a plan from (phase, start in s), a duration in s and a sample rate in Hz.

        Raises:
            SatvibError: phases out of order, or more samples than can be counted.
        """
        latest = max((duration, *(start for _, start in steps)))
        if not latest * rate < _MOST_SAMPLES:
            raise SatvibError(f'duration: {latest:g} s at {rate:g} Hz are too many samples')
        return cls(
            tuple(phase for phase, _ in steps),
            tuple(round(start * rate) for _, start in steps),
            round(duration * rate),
        )

    def index(self, sequence: int) -> int:
        """Position in `phases` at a sample."""
        return bisect_right(self.first, sequence) - 1

    def at(self, sequence: int) -> Phase:
        """Phase of a sample."""
        return self.phases[self.index(sequence)]

    def start_of(self, sequence: int) -> int:
        """First sample of the phase that a sample belongs to."""
        return self.first[self.index(sequence)]

    def first_of(self, phase: Phase) -> int | None:
        """First sample of the first phase of that kind, None when there is none."""
        for candidate, first in zip(self.phases, self.first, strict=True):
            if candidate == phase:
                return first
        return None

    @cached_property
    def _identification(self) -> int | None:
        return self.first_of(Phase.IDENTIFY)

    def is_hand_over(self, sequence: int, period: int) -> bool:
        """Whether a controller takes the identified model of the sample before this one.

        That is at the first sample of every ADAPT and CONTROL after an IDENTIFY, and at every `period`-th sample
        after the first of IDENTIFY (0: only at the phase changes).
        """
        start = self._identification
        if start is None or sequence <= start:
            return False
        if sequence in self.first and self.at(sequence) in (Phase.ADAPT, Phase.CONTROL):
            return True
        return period > 0 and (sequence - start) % period == 0

    def has_hand_over(self, first: int, last: int, period: int) -> bool:
        """Whether any sample from `first` to `last` is one, however many these are."""
        start = self._identification
        if start is None or (first := max(first, start + 1)) > last:
            return False
        if period > 0 and start + -(-(first - start) // period) * period <= last:
            return True
        return any(first <= k <= last and self.is_hand_over(k, 0) for k in self.first)
