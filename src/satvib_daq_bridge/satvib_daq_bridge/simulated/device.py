# SPDX-FileCopyrightText: 2026 The satvib authors
# SPDX-License-Identifier: Apache-2.0
"""The reference model of a device: what docs/serial_protocol.md asks of a firmware.

The emulator adds a pseudo-terminal and a simulated plant. The firmware in C++ does the same; a test compares the two.
Times are whole microseconds of any clock that never goes back.

Safety, in order: a frame with a wrong CRC is ignored; a command acts only within its session, in order, and when it
answers a sample no older than `lifetime`; without a fresh command for `lifetime` the outputs are at 0 V and stay there
until a command without `enable` has been seen; an output never exceeds the limit that CONFIGURE set.
"""

from dataclasses import replace

from satvib_daq_bridge.protocol.framing import FrameReader
from satvib_daq_bridge.protocol.messages import (
    VERSION,
    Command,
    Configure,
    Configured,
    Flag,
    Hello,
    Hold,
    Identity,
    Message,
    Refusal,
    Sample,
    Stop,
    Zero,
    newer,
    read_stream,
    to_wire,
)

_LONGEST_PERIOD = 1_000_000_000  # ns
_LONGEST_LIFETIME = 50_000  # us


class Device:
    """A device that speaks the protocol.

    Args:
        identity: what it is; session and number are filled in.

    Attributes:
        configured: the session, None before the first CONFIGURE and after a STOP.
        begun: us, when the session began; sample 0 is due one period later.
        enabled: whether the outputs follow commands.
        zeroed: why the outputs were last put to 0 V, for the log.
    """

    def __init__(self, identity: Identity) -> None:
        self.identity = replace(identity, version=VERSION)
        self.configured: Configure | None = None
        self.begun = 0
        self.enabled = False
        self.zeroed = 'power-up'
        self.refused = 0
        self.dropped = 0
        self.samples = 0
        self.reader = FrameReader()
        self._latch = Flag(0)
        self._closed = True
        self._overrun = False
        self._command = 0
        self._received_at = 0
        self._start: tuple[float, ...] = (0.0,) * identity.outputs
        self._target: tuple[float, ...] = self._start
        self._arrived = 0

    def receive(self, data: bytes, now: int) -> bytes:
        """Take bytes from the host at a time (us); gives the bytes to answer with."""
        return b''.join(self._take(message, now) for message in read_stream(self.reader, data))

    def take_sample(self, inputs: tuple[int, ...], now: int) -> bytes:
        """Send a sample (uV) taken at a time (us); gives the bytes."""
        if self.configured is None:
            return b''
        self.watch(now)
        flags = self._latch
        flags |= Flag.ENABLED if self.enabled else Flag(0)
        flags |= Flag.OVERRUN if self._overrun else Flag(0)
        message = Sample(
            session=self.configured.session,
            number=self.samples & 0xFFFFFFFF,
            time=now & 0xFFFFFFFF,
            flags=flags,
            command=self._command,
            rejected=self.reader.rejected & 0xFFFF,
            refused=self.refused & 0xFFFF,
            dropped=self.dropped & 0xFFFF,
            inputs=inputs[: self.configured.inputs],
        )
        self.samples += 1
        self._overrun = False
        return to_wire(message)

    def overrun(self) -> None:
        """Note that a sample was taken late."""
        self._overrun = True

    def watch(self, now: int) -> None:
        """Put the outputs to 0 V when no command has come for too long; call it often."""
        if self.enabled and self.configured and now - self._received_at >= self.configured.lifetime:
            self._zero('no command within its lifetime', Flag.EXPIRED)

    def chain(self, closed: bool) -> None:
        """Take the contact of the enable chain; an open chain puts the outputs to 0 V and latches. Call it often."""
        self._closed = closed
        if not closed:
            self._zero('the enable chain is open', Flag.OPENED)

    def expires(self) -> int | None:
        """When `watch` would act (us); None when it need not."""
        if not (self.enabled and self.configured):
            return None
        return self._received_at + self.configured.lifetime

    def outputs(self, now: int) -> tuple[float, ...]:
        """Voltages at the terminals at a time (uV)."""
        setup = self.configured
        if setup is None or setup.hold is Hold.ZERO:
            return self._target
        share = min((now - self._arrived) * 1000 / setup.period, 1.0)
        return tuple(a + (b - a) * share for a, b in zip(self._start, self._target, strict=True))

    @property
    def targets(self) -> tuple[float, ...]:
        """Voltages that the terminals go to (uV)."""
        return self._target

    def _take(self, message: Message, now: int) -> bytes:
        if isinstance(message, Command):
            self._take_command(message, now)
        elif isinstance(message, Zero):
            self._zero('told to', Flag.ZEROED)
        elif isinstance(message, Stop):
            self._zero('told to stop', Flag.ZEROED)
            self.configured = None
        elif isinstance(message, Hello):
            identity = replace(self.identity, session=message.session, number=message.number)
            return to_wire(identity)
        elif isinstance(message, Configure):
            refusal = self._refusal(message)
            if refusal is Refusal.NONE:
                self._begin(message, now)
            return to_wire(Configured(message.session, message.number, refusal))
        return b''

    def _refusal(self, asked: Configure) -> Refusal:
        if not self.identity.shortest_period <= asked.period <= _LONGEST_PERIOD:
            return Refusal.PERIOD
        if not 0 < asked.lifetime <= _LONGEST_LIFETIME:
            return Refusal.LIFETIME
        if asked.inputs > self.identity.inputs or len(asked.limits) != self.identity.outputs:
            return Refusal.COUNTS
        if min(asked.limits) < 0:
            return Refusal.LIMITS
        return Refusal.NONE

    def _begin(self, setup: Configure, now: int) -> None:
        self._zero('a new session', Flag(0))
        self._release()
        self.configured = setup
        self.begun = now
        self.samples = 0
        self.refused = self.dropped = 0
        self._command = 0

    def _take_command(self, command: Command, now: int) -> None:
        setup = self.configured
        if setup is None or command.session != setup.session:
            self.refused += 1
            return
        self.watch(now)
        in_order = newer(command.number, self._command)
        if not command.enable:
            # in any order: a command to 0 V is always taken; only the release of a latch must be in order
            if self.enabled:
                self._zero('no longer enabled', Flag(0))
            if in_order:
                self._command = command.number
                self._release()
            return
        age = (self.samples - 1 - command.sample) & 0xFFFFFFFF
        fresh = age * setup.period <= setup.lifetime * 1000
        fits = len(command.outputs) == self.identity.outputs
        if not (in_order and fresh and fits) or self._latch:
            self.refused += 1
            return
        self._command = command.number
        self._start, self._arrived = self.outputs(now), now
        self._target = tuple(
            float(min(max(value, -limit), limit))
            for value, limit in zip(command.outputs, setup.limits, strict=True)
        )
        self.enabled, self._received_at = True, now

    def _release(self) -> None:
        self._latch = Flag(0) if self._closed else Flag.OPENED

    def _zero(self, why: str, latch: Flag) -> None:
        self.enabled = False
        self.zeroed = why
        self._latch |= latch
        self._start = self._target = (0.0,) * self.identity.outputs
