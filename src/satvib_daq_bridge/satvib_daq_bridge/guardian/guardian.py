# SPDX-FileCopyrightText: 2026 The satvib authors
# SPDX-License-Identifier: Apache-2.0
"""The guardian: the small process that owns the outputs.

It holds the back end and the output guard, and nothing that computes. Samples go up to the bridge, voltages come down,
and every one of them passes the guard. When the bridge dies, by whatever signal, the line between them ends and the
outputs go to 0 V; the same on SIGTERM, SIGINT, a fault, or any error here. What it cannot survive is its own SIGKILL:
then the device's watchdog is what is left, and the bridge, which notices and sends somebody to zero the outputs.

Voltages leave once per sample: when every strut has answered it, or, when the next sample is there first, with those
that have. In every state but ACTIVE, 0 V leaves with each sample.
"""

import argparse
import contextlib
import math
import os
import select
import signal
import socket
import sys
import time
from collections.abc import Callable
from types import FrameType
from typing import Any

import numpy as np
from satvib_common.errors import SatvibError
from satvib_common.realtime import set_priority, set_processor

from satvib_daq_bridge.back_ends import make_back_end
from satvib_daq_bridge.back_ends.base import BackEnd, BackEndError, EndOfRecordError, Reading
from satvib_daq_bridge.channels import parse_channels
from satvib_daq_bridge.guardian import link as line
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
        bridge: the line.
        clock: s of the monotonic clock.
    """

    def __init__(
        self,
        back_end: BackEnd,
        guard: OutputGuard,
        bridge: line.Line,
        clock: Callable[[], float] = time.monotonic,
    ) -> None:
        self.back_end, self.guard, self.bridge, self.clock = back_end, guard, bridge, clock
        self.over = False
        self.state = State.IDLE
        count = len(guard.names)
        self._demand = np.zeros(count)
        self._answers = np.full(count, -1)
        self._times: dict[int, float] = {}
        self._now = -1  # the sample that is out
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
        self.hear()
        try:
            self._poll()
            if self.state is State.ACTIVE and self.clock() >= self._stale_at():
                self._apply()
        except EndOfRecordError as ended:
            self.guard.zero()
            self.bridge.send(line.pack_text(line.ENDED, str(ended)))
            self.over = True
        except BackEndError as error:
            self._fault(str(error))
            self.over = True
        # also the sign that this process lives, whatever the device does
        if self.clock() - self._figures_at >= _FIGURES_EVERY:
            self._figures_at = self.clock()
            self._tell_figures()
        return [fd for fd in ready if fd in others]

    def hear(self) -> None:
        """Take what the bridge says."""
        while message := self.bridge.receive():
            self._take(message)
        if self.bridge.closed:
            self.over = True

    def finish(self) -> None:
        """Go to 0 V and let go of the devices, whatever happens."""
        self.guard.zero()
        with contextlib.suppress(Exception):
            self.back_end.zero()
        with contextlib.suppress(Exception):
            self.back_end.close()

    def _take(self, message: bytes) -> None:
        kind = message[0]
        try:
            if kind == line.COMMAND:
                self._command(*line.read_command(message))
            elif kind == line.MODE:
                self._mode(State(message[1]))
            elif kind == line.RESET:
                self.guard.reset()
            elif kind == line.BEGIN:
                self.back_end.begin_run()
            elif kind == line.NEXT and not self._left:
                self._apply()
            elif kind == line.QUIT:
                self.over = True
        except BackEndError as error:
            self._fault(str(error))
            self.over = True

    def _command(self, strut: int, sequence: int, voltage: float) -> None:
        """Keep a voltage, unless it answers an older sample than the one before, or one that was never taken."""
        if not 0 <= strut < len(self._demand) or not self._answers[strut] <= sequence <= self._now:
            return
        self._demand[strut], self._answers[strut] = voltage, sequence
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
        taken = line.Taken(
            reading.sequence,
            reading.time,
            reading.late,
            self._latency,
            reading.volts,
            self.guard.coil,
            self._saturated,
        )
        self._latency = math.nan
        self.bridge.send(line.pack_sample(taken))
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
        """Let the voltages out that are there."""
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
        # what a device may believe is as old as its oldest part
        answers = int(self._answers.min()) if enable else max(self._now, 0)
        self.back_end.write(converter, answers, enable, now)

    def _fault(self, reason: str) -> None:
        """Latch 0 V and say why."""
        self.guard.zero(reason)
        self.back_end.zero()
        self.bridge.send(line.pack_text(line.FAULT, reason))

    def _tell_figures(self) -> None:
        figures = self.back_end.figures()
        figures['deadlines missed'] = float(self.deadlines_missed)
        figures['samples not taken by the bridge'] = float(self.bridge.unsent)
        for name, load in zip(self.guard.names, self.guard.load, strict=True):
            figures[f'{name} load'] = float(load)
        self.bridge.send(line.pack_text(line.FIGURES, figures))


def set_up(given: dict[str, Any], bridge: line.Line) -> Guardian:
    """Build a guardian from what the bridge says first.

    Raises:
        SatvibError: channels, options or devices that are not right.
    """
    channels = parse_channels(given['channels'], given['where'])
    period, max_age = 1.0 / given['sample_rate'], given['command_timeout']
    channels.check_rate(given['sample_rate'])
    back_end = make_back_end(channels, period, max_age)
    guard = OutputGuard(channels.outputs, period, max_age)
    return Guardian(back_end, guard, bridge)


def schedule(cpu: int, priority: int) -> list[str]:
    """Ask for a processor and SCHED_FIFO; gives what was not permitted."""
    refused: list[str] = []
    set_processor(cpu, refused.append)
    set_priority(priority, refused.append)
    return refused


def _serve(bridge: line.Line) -> int:
    """Read the set-up, then guard until the end."""
    alarm, bell = os.pipe()

    def end(_: int, __: FrameType | None) -> None:
        os.write(bell, b'!')

    for number in (signal.SIGTERM, signal.SIGINT, signal.SIGHUP):
        signal.signal(number, end)
    ready, _, _ = select.select([bridge.fileno(), alarm], [], [], 10.0)
    message = b'' if alarm in ready else bridge.receive()
    if not message:
        return 1
    guardian: Guardian | None = None
    try:
        given = line.read_text(message)
        guardian = set_up(given, bridge)
        found = guardian.back_end.open()
        refused = schedule(given['cpu'], given['priority'])
        if given.get('only_zero'):
            guardian.back_end.zero()
            return 0
        guardian.start()
        bridge.send(
            line.pack_text(
                line.READY,
                {'found': found, 'refused': refused, 'virtual': guardian.back_end.virtual},
            )
        )
        while not guardian.over:
            if guardian.step([alarm]):
                break
    except (SatvibError, BackEndError) as error:
        bridge.send(line.pack_text(line.ERROR, str(error)))
        return 2
    finally:
        if guardian is not None:
            guardian.finish()
    return 0


def main(arguments: list[str] | None = None) -> int:
    """Run a guardian on the descriptor that its bridge gave it."""
    parser = argparse.ArgumentParser(prog='guardian', description=__doc__.splitlines()[0])
    parser.add_argument('descriptor', type=int, help='of the line to the bridge')
    given = parser.parse_args(arguments)
    return _serve(line.Line(socket.socket(fileno=given.descriptor)))


if __name__ == '__main__':
    sys.exit(main())
