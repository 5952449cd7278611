# SPDX-FileCopyrightText: 2026 The satvib authors
# SPDX-License-Identifier: Apache-2.0
"""Back ends without a device: a sample comes by the clock, or after each answer.

`pace: realtime`: sample k comes when its time has come. `pace: lockstep`: sample k + 1 comes when sample k has been
answered; no clock, time is k periods.
"""

from satvib_daq_bridge.back_ends.base import BackEnd
from satvib_daq_bridge.back_ends.pace.ticker import Ticker
from satvib_daq_bridge.channels import Channels

PACES = ('realtime', 'lockstep')


class Paced(BackEnd):
    """A back end without a device.

    Args:
        channels: all channels.
        period: s, sample period.
        lifetime: s.
        pace: one of `PACES`.
    """

    def __init__(self, channels: Channels, period: float, lifetime: float, pace: str) -> None:
        super().__init__(channels, period, lifetime)
        self.virtual = pace == 'lockstep'
        self._ticker = Ticker(period)
        self._sequence = -1
        self._answered = True
        self._run_begins = False

    def start(self, now: float) -> None:
        """Start the clock."""
        self._ticker.start(now)

    def begin_run(self) -> None:
        """Take note that the next sample is the first of a run."""
        self._run_begins = True

    def due(self) -> float:
        """When the next sample is."""
        if self.virtual:
            return 0.0 if self._answered else float('inf')
        return self._ticker.due()

    def close(self) -> None:
        """Do nothing: nothing is open."""

    def next_sample(self, now: float) -> tuple[int, float, float] | None:
        """Give index, time (s) and lateness (s) of the sample that is due, None when none is."""
        if self.virtual:
            if not self._answered:
                return None
            index = self._sequence + 1
            return index, index * self.period, 0.0
        tick = self._ticker.take(now)
        if tick is None:
            return None
        index, time = tick
        return index, time, now - time

    def answer(self, sequence: int) -> None:
        """Take note of an answer: that of the present sample lets the next one come in lockstep."""
        self._answered = self._answered or sequence == self._sequence
