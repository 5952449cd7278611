# SPDX-FileCopyrightText: 2026 The satvib authors
# SPDX-License-Identifier: Apache-2.0
"""Pairs the acceleration of sample k with the voltage of sample k - delay, by `sequence`.

A source of samples that says what the coil got (`add_applied`) counts more than the controller: its sample holds the
voltage of the one before. Of other sources the voltage that was asked for is taken. That has its own topic, so either
may arrive first. In lockstep a sample waits for its voltage. In real time the voltage has until the next sample. When a
newer voltage has arrived, an older one is lost: it is NaN, not known. Before sample 0 the voltage is known to be 0.
"""

import math
import time
from collections import deque
from collections.abc import Iterator
from typing import Generic, TypeVar

from satvib_common.sequence import Arrival, SequenceTracker

T = TypeVar('T')


class VoltagePairing(Generic[T]):
    """Samples that wait for their voltage.

    Args:
        delay: samples between a voltage and the first acceleration that sees it.
        wait: wait for a voltage as long as it may still come.
        samples: classifies the samples; by default one of its own.
        rate: Hz, of the samples, which follow the clock as long as nothing waits; 0: they follow none.
    """

    def __init__(
        self, delay: int, wait: bool, samples: SequenceTracker | None = None, rate: float = 0.0
    ) -> None:
        self.delay, self._rate = delay, rate
        self.unknown = 0
        self.samples = samples or SequenceTracker()
        self.voltages = SequenceTracker(confirm=True)
        self.set_wait(wait)
        self._waiting: deque[tuple[int, T, Arrival]] = deque()
        self._known: dict[int, float] = {}
        self._applied = -1  # the last sample of which it is known what the coil got

    def set_wait(self, wait: bool) -> None:
        """Wait from now on, or no more."""
        self.wait = self.voltages.zero_restarts = self.samples.zero_restarts = wait
        if self._rate:
            self.samples.follow(None if wait else lambda: time.monotonic() * self._rate)

    def __len__(self) -> int:
        """Number of samples that wait."""
        return len(self._waiting)

    def add_voltage(self, sequence: int, voltage: float) -> None:
        """Take a voltage as the guard let it out."""
        arrival = self.voltages.classify(sequence)
        if arrival is Arrival.STRAY:
            return
        if arrival is Arrival.RESTART:
            self._known.clear()
            self._applied = -1
        if sequence > self._applied:
            self._known[sequence] = voltage

    def add_applied(self, sequence: int, voltage: float) -> None:
        """Take what the coil got for a sample, which stands above what was asked for; NaN: not known."""
        if sequence >= 0:
            self._applied = sequence
            self._known[sequence] = voltage

    def add_sample(self, sequence: int, sample: T) -> Arrival:
        """Take a sample; a repeated one is left out."""
        arrival = self.samples.classify(sequence)
        if arrival is Arrival.RESTART:
            self._waiting.clear()
            if self.voltages.restarts < self.samples.restarts:
                # what is known belongs to the run before
                self._known.clear()
                self._applied = -1
                self.voltages.last = None
                self.voltages.restarts = self.samples.restarts
        if arrival not in {Arrival.REPEAT, Arrival.STRAY}:
            self._waiting.append((sequence, sample, arrival))
        return arrival

    def pairs(self) -> Iterator[tuple[T, float, Arrival]]:
        """Give each sample whose voltage is there or is lost, in order: sample, voltage, and how the sample arrived."""
        while self._waiting:
            wanted = self._waiting[0][0] - self.delay
            voltage = 0.0 if wanted < 0 else self._known.get(wanted)
            if voltage is None:
                newest = self.voltages.last
                passed = (newest is not None and newest > wanted) or self._applied > wanted
                if not passed and (self.wait or len(self._waiting) < 2):
                    return
                voltage = math.nan
                self.unknown += 1
            self._forget(wanted)
            _, sample, arrival = self._waiting.popleft()
            yield sample, voltage, arrival

    def _forget(self, wanted: int) -> None:
        """Drop what is older than this pair."""
        self._known.pop(wanted - 1, None)
        if len(self._known) > 4000:
            self._known = {s: v for s, v in self._known.items() if s >= wanted}
