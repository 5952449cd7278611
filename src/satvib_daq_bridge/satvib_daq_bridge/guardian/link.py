# SPDX-FileCopyrightText: 2026 The satvib authors
# SPDX-License-Identifier: Apache-2.0
"""Messages between the bridge and its guardian, over a socket pair that keeps messages whole (SOCK_SEQPACKET).

The first byte is the kind. When one process ends, the other reads the end of the link at once. So a guardian notices
that its bridge was killed.
"""

import json
import socket
import struct
from dataclasses import dataclass
from enum import IntEnum
from typing import Any

import numpy as np
from satvib_common.arrays import Array

from satvib_daq_bridge.states import State

_COMMAND = struct.Struct('<BHQd')
_SAMPLE = struct.Struct('<BQdddIHH')
_LONGEST = 65536


class ToGuardian(IntEnum):
    """Kinds of messages from the bridge."""

    SETUP = 1  # JSON: channels and options
    COMMAND = 2  # the voltage of one strut
    MODE = 3  # the state of the bridge
    RESET = 4  # release the fault
    BEGIN = 5  # the next sample is the first of a run
    NEXT = 6  # without a clock: go on to the next sample
    QUIT = 7


class ToBridge(IntEnum):
    """Kinds of messages from the guardian."""

    READY = 65  # JSON: what was found
    ERROR = 66  # JSON: what is wrong with the set-up
    SAMPLE = 67
    FAULT = 68  # JSON: why all outputs are at 0 V
    ENDED = 69  # JSON: the recording that is played has ended
    FIGURES = 70  # JSON: counts for people


@dataclass(frozen=True)
class Taken:
    """A sample as the bridge gets it.

    Attributes:
        sequence: index since the guardian began.
        time: s of the monotonic clock, when it was taken.
        late: s, how much later it was there.
        latency: s from the sample before to its voltages leaving; NaN when they did not.
        volts: (inputs) V.
        coil: (outputs) V at the coils now.
        saturated: bit i: a limit changed the demand of output i.
    """

    sequence: int
    time: float
    late: float
    latency: float
    volts: Array
    coil: Array
    saturated: int


def pack_sample(taken: Taken) -> bytes:
    """Give the message of a sample."""
    head = _SAMPLE.pack(
        ToBridge.SAMPLE,
        taken.sequence,
        taken.time,
        taken.late,
        taken.latency,
        taken.saturated,
        len(taken.volts),
        len(taken.coil),
    )
    return head + taken.volts.tobytes() + taken.coil.tobytes()


def read_sample(message: bytes) -> Taken:
    """Read the message of a sample."""
    _, sequence, time, late, latency, saturated, inputs, _ = _SAMPLE.unpack_from(message)
    values = np.frombuffer(message, dtype=float, offset=_SAMPLE.size)
    return Taken(
        sequence=sequence,
        time=time,
        late=late,
        latency=latency,
        volts=values[:inputs],
        coil=values[inputs:],
        saturated=saturated,
    )


def pack_command(strut_index: int, sequence: int, voltage: float) -> bytes:
    """Give the message of one strut's voltage, computed from a sample."""
    return _COMMAND.pack(ToGuardian.COMMAND, strut_index, sequence, voltage)


def read_command(message: bytes) -> tuple[int, int, float]:
    """Read strut index, sequence and voltage."""
    _, strut_index, sequence, voltage = _COMMAND.unpack(message)
    return strut_index, sequence, voltage


def pack_mode(state: State) -> bytes:
    """Give the message of a state."""
    return bytes([ToGuardian.MODE, state.value])


def pack(kind: ToGuardian) -> bytes:
    """Give a message without content."""
    return bytes([kind])


def pack_text(kind: int, content: Any) -> bytes:
    """Give a message whose content is JSON."""
    return bytes([kind]) + json.dumps(content).encode()


def read_text(message: bytes) -> Any:
    """Read the content of such a message."""
    return json.loads(message[1:])


class Link:
    """One end of the link.

    Attributes:
        closed: the other end is gone.
        unsent: messages for which there was no room.
    """

    def __init__(self, end: socket.socket) -> None:
        self._socket = end
        end.setblocking(False)
        self.closed = False
        self.unsent = 0

    def fileno(self) -> int:
        """The descriptor, for `select`."""
        return self._socket.fileno()

    def send(self, message: bytes) -> bool:
        """Send without waiting; gives whether it went."""
        try:
            self._socket.send(message)
        except BlockingIOError:
            self.unsent += 1
            return False
        except OSError:
            self.closed = True
            return False
        return True

    def receive(self) -> bytes:
        """Give the next message; empty when there is none now, or no more (`closed`)."""
        try:
            message = self._socket.recv(_LONGEST)
        except BlockingIOError:
            return b''
        except OSError:
            message = b''
        if not message:
            self.closed = True
        return message

    def close(self) -> None:
        """Close this end."""
        self.closed = True
        self._socket.close()


def pair() -> tuple[socket.socket, socket.socket]:
    """Make the two ends."""
    one, other = socket.socketpair(socket.AF_UNIX, socket.SOCK_SEQPACKET)
    for end in (one, other):
        # room for about a second of samples while the reader is held up
        end.setsockopt(socket.SOL_SOCKET, socket.SO_SNDBUF, 1 << 20)
    return one, other
