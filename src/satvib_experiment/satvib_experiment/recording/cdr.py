# SPDX-FileCopyrightText: 2026 The satvib authors
# SPDX-License-Identifier: Apache-2.0
"""A few fields out of a serialized message, without deserializing it.

Every message of a strut begins with a std_msgs/Header and then its uint64 `sequence`. In CDR (little endian, as ROS 2
writes it) that is: 4 bytes of encapsulation, int32 sec, uint32 nanosec, uint32 length and text of frame_id, padding to
8 bytes, counted from the end of the encapsulation, and the sequence. What follows the sequence is eight bytes each, as
long as it is float64.
"""

import math
import struct
from typing import Any

_HEADER = struct.Struct('<iII')
_SEQUENCE = struct.Struct('<Q')
_LENGTH = struct.Struct('<I')
_ACCELERATION = struct.Struct('<Q3d2B6xdB')
_APPLIED, _APPLIED_AT = struct.Struct('<dB'), 40  # bytes behind the beginning of the sequence
_FIGURES = tuple(struct.Struct(f'<Q{count}d') for count in range(4))


def stamp_and_sequence(message: bytes) -> tuple[int, int]:
    """Give the header's stamp in ns and the sequence of a strut's message."""
    sec, nanosec, length = _HEADER.unpack_from(message, 4)
    at = 4 + ((12 + length + 7) & ~7)
    return sec * 1_000_000_000 + nanosec, _SEQUENCE.unpack_from(message, at)[0]


def sequence_and_figures(message: bytes, count: int) -> tuple[Any, ...]:
    """Give the sequence of a strut's message, and the `count` float64 that follow it."""
    return _FIGURES[count].unpack_from(message, _sequence_at(message))


def acceleration_figures(message: bytes) -> tuple[int, float, float, float, float, int]:
    """Sequence, sample period, upper, lower, `applied` and `applied_state` of a StrutAcceleration."""
    at = _sequence_at(message)
    k, period, upper, lower = _FIGURES[3].unpack_from(message, at)
    if len(message) < at + _ACCELERATION.size:  # of a time when it did not have them
        return k, period, upper, lower, math.nan, 0
    return k, period, upper, lower, *_APPLIED.unpack_from(message, at + _APPLIED_AT)


def _sequence_at(message: bytes) -> int:
    length = _LENGTH.unpack_from(message, 12)[0]
    return 4 + ((12 + length + 7) & ~7)
