# SPDX-FileCopyrightText: 2026 The satvib authors
# SPDX-License-Identifier: Apache-2.0
"""The guardian: the small process that owns the outputs.

It holds the back end and the output guard, and nothing that computes. Samples go up to the bridge, voltages come down,
and every one of them passes the guard. When the bridge ends, by any signal, the link between them ends and the outputs
go to 0 V; the same on SIGTERM, SIGINT, a fault, or any error here. After its own SIGKILL it can do nothing: then the
device's watchdog acts, and the bridge notices and starts another guardian that puts the outputs to 0 V.

Voltages leave once per sample: when every strut has answered it, or, when the next sample is there first, with those
that have. In every state but ACTIVE, 0 V leaves with each sample.
"""

import contextlib
import math
import select
import time
from collections.abc import Callable

import numpy as np

from satvib_daq_bridge.back_ends.base import BackEnd, BackEndError, EndOfRecordError, Reading
from satvib_daq_bridge.guardian import link
from satvib_daq_bridge.guardian.output_guard import OutputGuard
from satvib_daq_bridge.states import State

# samples whose times are remembered; a command for an older one has no age and is refused
_MEMORY = 256
_FIGURES_EVERY = 0.5  # s


class Guardian:
    """Everything between a back end and a bridge.

    Args:
        back_end: open and not yet started.
        guard: of all its outputs.
        bridge: its end of the link.
        clock: s of the monotonic clock.
    """

    def __init__(
        self,
        back_end: BackEnd,
        guard: OutputGuard,
        bridge: link.Link,
        clock: Callable[[], float] = time.monotonic,
    ) -> None:
        self.back_end, self.guard, self.bridge, self.clock = back_end, guard, bridge, clock
        self.over = False
        self.state = State.IDLE
        count = len(guard.names)
        self._demand = np.zeros(count)
        self._answers = np.full(count, -1)
        self._times: dict[int, float] = {}
        self._now = -1  # the present sample
        self._left = True  # voltages have left for it
        self._applied_at = 0.0
        self._latency = math.nan
        self._saturated = 0
        self._figures_at = 0.0
        self.deadlines_missed = 0

    def start(self) -> None:
        """Begin to sample."""
        now = self.clock()
        self._applied_at = self._figures_at = now
        self.back_end.start(now)

    def step(self, others: list[int]) -> list[int]:
        """Wait for what comes first, and do it; gives which of the `others` (descriptors) are readable."""
        now = self.clock()
        device = self.back_end.fileno()
        wanted = [self.bridge.fileno(), *others] + ([device] if device >= 0 else [])
        wait = min(self.back_end.due(), self._stale_at()) - now
        ready, _, _ = select.select(wanted, [], [], min(max(wait, 0.0), 0.25))
        # commands first: a voltage that is there already is not late
        self.receive()
        try:
            self._poll()
            if self.state is State.ACTIVE and self.clock() >= self._stale_at():
                self._apply()
        except EndOfRecordError as ended:
            self.guard.zero()
            self.bridge.send(link.pack_text(link.ToBridge.ENDED, str(ended)))
            self.over = True
        except BackEndError as error:
            self._fault(str(error))
            self.over = True
        # also tells the bridge that this process runs, when the device sends nothing
        if self.clock() - self._figures_at >= _FIGURES_EVERY:
            self._figures_at = self.clock()
            self._tell_figures()
        return [fd for fd in ready if fd in others]

    def receive(self) -> None:
        """Read the messages of the bridge."""
        while message := self.bridge.receive():
            self._take(message)
        if self.bridge.closed:
            self.over = True

    def finish(self) -> None:
        """Go to 0 V and close the devices, also after errors."""
        self.guard.zero()
        with contextlib.suppress(Exception):
            self.back_end.zero()
        with contextlib.suppress(Exception):
            self.back_end.close()

    def _take(self, message: bytes) -> None:
        kind = message[0]
        try:
            if kind == link.ToGuardian.COMMAND:
                self._command(*link.read_command(message))
            elif kind == link.ToGuardian.MODE:
                self._mode(State(message[1]))
            elif kind == link.ToGuardian.RESET:
                self.guard.reset()
            elif kind == link.ToGuardian.BEGIN:
                self.back_end.begin_run()
            elif kind == link.ToGuardian.NEXT and not self._left:
                self._apply()
            elif kind == link.ToGuardian.QUIT:
                self.over = True
        except BackEndError as error:
            self._fault(str(error))
            self.over = True

    def _command(self, strut_index: int, sequence: int, voltage: float) -> None:
        """Keep a voltage, unless it answers an older sample than the one before, or one that was never taken."""
        known = 0 <= strut_index < len(self._demand)
        if not known or not self._answers[strut_index] <= sequence <= self._now:
            return
        self._demand[strut_index], self._answers[strut_index] = voltage, sequence
        if not self._left and (self._answers == self._now).all():
            self._apply()

    def _mode(self, state: State) -> None:
        before, self.state = self.state, state
        if before is State.ACTIVE and state is not State.ACTIVE:
            self._write(self.guard.zero().converter, self.clock())

    def _poll(self) -> None:
        for reading in self.back_end.poll(self.clock()):
            self._sample(reading)

    def _sample(self, reading: Reading) -> None:
        if not self._left:
            # the period is over: what has come leaves, and who has not answered is late
            self.deadlines_missed += self.state is State.ACTIVE
            if self.state is State.ACTIVE:
                self._apply()
        self._now, self._left = reading.sequence, False
        self._times[reading.sequence] = reading.time
        while len(self._times) > _MEMORY:
            del self._times[next(iter(self._times))]
        taken = link.Taken(
            sequence=reading.sequence,
            time=reading.time,
            late=reading.late,
            latency=self._latency,
            volts=reading.volts,
            coil=self.guard.coil,
            saturated=self._saturated,
        )
        self._latency = math.nan
        self.bridge.send(link.pack_sample(taken))
        if reading.fault:
            self._fault(reading.fault)
        if self.state is not State.ACTIVE and not self.back_end.virtual:
            self._apply()

    def _ages(self, now: float) -> np.ndarray:
        if self.back_end.virtual:
            return (self._now - self._answers) * self.guard.period
        return np.array([now - self._times.get(int(k), -math.inf) for k in self._answers])

    def _stale_at(self) -> float:
        """When the oldest command becomes too old, s."""
        if self.state is not State.ACTIVE or self.back_end.virtual or self.guard.fault:
            return math.inf
        oldest = min(self._times.get(int(k), -math.inf) for k in self._answers)
        return oldest + self.guard.max_age + 1e-6

    def _apply(self) -> None:
        """Write the voltages that have arrived."""
        now = self.clock()
        elapsed = self.guard.period if self.back_end.virtual else now - self._applied_at
        self._applied_at = now
        before = self.guard.fault
        output = self.guard.apply(self._demand, self._ages(now), self.state, elapsed)
        self._saturated = sum(1 << i for i, s in enumerate(output.saturated) if s)
        self._left = True
        if self.state is State.ACTIVE and not self.back_end.virtual:
            self._latency = now - self._times.get(self._now, math.nan)
        self._write(output.converter, now)
        if output.fault and not before:
            self._fault(output.fault)

    def _write(self, converter: np.ndarray, now: float) -> None:
        enable = self.state is State.ACTIVE and not self.guard.fault
        # a command is as old as its oldest voltage
        answers = int(self._answers.min()) if enable else max(self._now, 0)
        self.back_end.write(converter, answers, enable, now)

    def _fault(self, reason: str) -> None:
        """Latch 0 V and report the reason."""
        self.guard.zero(reason)
        self.back_end.zero()
        self.bridge.send(link.pack_text(link.ToBridge.FAULT, reason))

    def _tell_figures(self) -> None:
        figures = self.back_end.figures()
        figures['deadlines missed'] = float(self.deadlines_missed)
        figures['samples not taken by the bridge'] = float(self.bridge.unsent)
        for name, load in zip(self.guard.names, self.guard.load, strict=True):
            figures[f'{name} load'] = float(load)
        self.bridge.send(link.pack_text(link.ToBridge.FIGURES, figures))
