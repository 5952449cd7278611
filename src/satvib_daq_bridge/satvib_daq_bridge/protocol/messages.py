# SPDX-FileCopyrightText: 2026 The satvib authors
# SPDX-License-Identifier: Apache-2.0
"""The messages of the protocol: what stands in a payload, byte by byte (docs/serial_protocol.md).

Everything is little-endian. A payload begins with type, session and number; voltages are whole microvolts at the
terminals. `parse` gives back only what is complete and has the length that its counts say.
"""

import struct
from dataclasses import dataclass
from enum import IntEnum, IntFlag
from typing import ClassVar

from satvib_daq_bridge.protocol.framing import FrameReader, frame

VERSION = 1
_HEAD = struct.Struct('<BHI')


class Kind(IntEnum):
    """First byte of a payload."""

    HELLO = 0x01
    CONFIGURE = 0x02
    COMMAND = 0x03
    ZERO = 0x04
    STOP = 0x05
    IDENTITY = 0x81
    CONFIGURED = 0x82
    SAMPLE = 0x83


class Hold(IntEnum):
    """How an output moves to its next value."""

    ZERO = 0
    LINEAR = 1


class Refusal(IntEnum):
    """Why a device does not take a CONFIGURE."""

    NONE = 0
    PERIOD = 1
    LIFETIME = 2
    COUNTS = 3
    LIMITS = 4


class Flag(IntFlag):
    """State of a device in each SAMPLE."""

    ENABLED = 1
    EXPIRED = 2
    ZEROED = 4
    OVERRUN = 8
    OPENED = 16


@dataclass(frozen=True)
class Hello:
    """Ask a device for its identity."""

    kind: ClassVar[Kind] = Kind.HELLO
    session: int = 0
    number: int = 0

    def body(self) -> bytes:
        """Give the bytes after the head."""
        return b''


@dataclass(frozen=True)
class Identity:
    """What a device is: counts, ranges in uV, its fastest period in ns."""

    kind: ClassVar[Kind] = Kind.IDENTITY
    layout: ClassVar[struct.Struct] = struct.Struct('<BBBBiiiiI16s')
    session: int
    number: int
    version: int
    inputs: int
    outputs: int
    bits: int
    input_low: int
    input_high: int
    output_low: int
    output_high: int
    shortest_period: int
    name: str

    def body(self) -> bytes:
        """Give the bytes after the head."""
        return self.layout.pack(
            self.version,
            self.inputs,
            self.outputs,
            self.bits,
            self.input_low,
            self.input_high,
            self.output_low,
            self.output_high,
            self.shortest_period,
            self.name.encode('ascii', 'replace')[:16],
        )


@dataclass(frozen=True)
class Configure:
    """Begin a session: period in ns, command lifetime in us, hold, and the largest |output| in uV of each output."""

    kind: ClassVar[Kind] = Kind.CONFIGURE
    layout: ClassVar[struct.Struct] = struct.Struct('<IIBBB')
    session: int
    number: int
    period: int
    lifetime: int
    hold: Hold
    inputs: int
    limits: tuple[int, ...]

    def body(self) -> bytes:
        """Give the bytes after the head."""
        head = self.layout.pack(
            self.period, self.lifetime, self.hold, self.inputs, len(self.limits)
        )
        return head + _volts(self.limits)


@dataclass(frozen=True)
class Configured:
    """The device's answer to a CONFIGURE."""

    kind: ClassVar[Kind] = Kind.CONFIGURED
    layout: ClassVar[struct.Struct] = struct.Struct('<B')
    session: int
    number: int
    refusal: Refusal

    def body(self) -> bytes:
        """Give the bytes after the head."""
        return self.layout.pack(self.refusal)


@dataclass(frozen=True)
class Command:
    """Voltages for the outputs in uV, computed from the sample `sample`."""

    kind: ClassVar[Kind] = Kind.COMMAND
    layout: ClassVar[struct.Struct] = struct.Struct('<IBB')
    session: int
    number: int
    sample: int
    enable: bool
    outputs: tuple[int, ...]

    def body(self) -> bytes:
        """Give the bytes after the head."""
        return self.layout.pack(self.sample, self.enable, len(self.outputs)) + _volts(self.outputs)


@dataclass(frozen=True)
class Zero:
    """0 V at once, in any session."""

    kind: ClassVar[Kind] = Kind.ZERO
    session: int = 0
    number: int = 0

    def body(self) -> bytes:
        """Give the bytes after the head."""
        return b''


@dataclass(frozen=True)
class Stop:
    """0 V at once and no more samples, in any session."""

    kind: ClassVar[Kind] = Kind.STOP
    session: int = 0
    number: int = 0

    def body(self) -> bytes:
        """Give the bytes after the head."""
        return b''


@dataclass(frozen=True)
class Sample:
    """One sample: time in us of the device's clock, state, the last command taken, counts, inputs in uV."""

    kind: ClassVar[Kind] = Kind.SAMPLE
    layout: ClassVar[struct.Struct] = struct.Struct('<IBIHHHB')
    session: int
    number: int
    time: int
    flags: Flag
    command: int
    rejected: int
    refused: int
    dropped: int
    inputs: tuple[int, ...]

    def body(self) -> bytes:
        """Give the bytes after the head."""
        head = self.layout.pack(
            self.time,
            self.flags,
            self.command,
            self.rejected,
            self.refused,
            self.dropped,
            len(self.inputs),
        )
        return head + _volts(self.inputs)


Message = Hello | Identity | Configure | Configured | Command | Zero | Stop | Sample


def pack(message: Message) -> bytes:
    """Give the payload of a message."""
    return _HEAD.pack(message.kind, message.session, message.number) + message.body()


def parse(payload: bytes) -> Message | None:
    """Give the message of a payload; None when it is none, or not of the length that it should have."""
    try:
        kind, session, number = _HEAD.unpack_from(payload)
        return _READ[kind](session, number, payload[_HEAD.size :])
    except (struct.error, KeyError, ValueError):
        return None


def to_wire(message: Message) -> bytes:
    """Give the bytes on the wire of a message."""
    return frame(pack(message))


def read_stream(reader: FrameReader, data: bytes) -> list[Message]:
    """Give the messages that are complete with the bytes that arrived."""
    return [m for m in map(parse, reader.feed(data)) if m is not None]


def newer(number: int, than: int) -> bool:
    """Whether a 32-bit number comes after another one (RFC 1982: less than half the circle ahead)."""
    return 0 < (number - than) & 0xFFFFFFFF < 0x80000000


def _volts(values: tuple[int, ...]) -> bytes:
    return struct.pack(f'<{len(values)}i', *values)


def _tail(body: bytes, size: int, count: int) -> tuple[int, ...]:
    if len(body) != size + 4 * count:
        raise ValueError('length')
    return struct.unpack_from(f'<{count}i', body, size)


def _empty(cls: type[Hello | Zero | Stop], session: int, number: int, body: bytes) -> Message:
    if body:
        raise ValueError('length')
    return cls(session, number)


def _identity(session: int, number: int, body: bytes) -> Message:
    fields = list(Identity.layout.unpack(body))
    fields[-1] = fields[-1].rstrip(b'\0').decode('ascii', 'replace')
    return Identity(session, number, *fields)


def _configure(session: int, number: int, body: bytes) -> Message:
    period, lifetime, hold, inputs, outputs = Configure.layout.unpack_from(body)
    limits = _tail(body, Configure.layout.size, outputs)
    return Configure(session, number, period, lifetime, Hold(hold), inputs, limits)


def _configured(session: int, number: int, body: bytes) -> Message:
    return Configured(session, number, Refusal(*Configured.layout.unpack(body)))


def _command(session: int, number: int, body: bytes) -> Message:
    sample, enable, count = Command.layout.unpack_from(body)
    outputs = _tail(body, Command.layout.size, count)
    if enable > 1:
        raise ValueError('enable')
    return Command(session, number, sample, bool(enable), outputs)


def _sample(session: int, number: int, body: bytes) -> Message:
    *head, count = Sample.layout.unpack_from(body)
    time, flags, command, rejected, refused, dropped = head
    inputs = _tail(body, Sample.layout.size, count)
    return Sample(session, number, time, Flag(flags), command, rejected, refused, dropped, inputs)


_READ = {
    Kind.HELLO: lambda s, n, b: _empty(Hello, s, n, b),
    Kind.ZERO: lambda s, n, b: _empty(Zero, s, n, b),
    Kind.STOP: lambda s, n, b: _empty(Stop, s, n, b),
    Kind.CONFIGURE: _configure,
    Kind.COMMAND: _command,
    Kind.IDENTITY: _identity,
    Kind.CONFIGURED: _configured,
    Kind.SAMPLE: _sample,
}
