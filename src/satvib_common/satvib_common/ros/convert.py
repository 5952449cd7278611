# SPDX-FileCopyrightText: 2026 The satvib authors
# SPDX-License-Identifier: Apache-2.0
"""Conversion between messages and the values of the mathematics."""

from array import array
from collections.abc import Mapping
from typing import Any

import numpy as np

from satvib_common.arrays import Array
from satvib_common.errors import SatvibError
from satvib_common.phases import Phase, PhasePlan

_SECOND = 1_000_000_000


def set_stamp(stamp: Any, time: int) -> None:
    """Put a time in ns into a builtin_interfaces/Time."""
    stamp.sec, stamp.nanosec = divmod(time, _SECOND)


def nanoseconds(stamp: Any) -> int:
    """Time of a builtin_interfaces/Time in ns."""
    total: int = stamp.sec * _SECOND + stamp.nanosec
    return total


def sample_stamp(sequence: int, period: float) -> int:
    """Instant of a sample in ns when the samples are the clock and sample 0 is at 0."""
    return round(sequence * period * _SECOND)


def set_header(message: Any, header: Any) -> None:
    """Put what a header says into that of a message; `header` may be that of a record (`wire`)."""
    stamp = message.header.stamp
    stamp.sec, stamp.nanosec = header.stamp.sec, header.stamp.nanosec
    message.header.frame_id = header.frame_id


def doubles(values: Array) -> 'array[float]':
    """Give the value of a float64[] field, without a list of Python numbers."""
    return array('d', np.ascontiguousarray(values).tobytes())


def fill(message: Any, figures: Mapping[str, Any], index: tuple[int, ...] = ()) -> None:
    """Put figures into the fields of a message that have their names.

    Args:
        message: is changed.
        figures: plain values, or arrays whose leading axes `index` picks from; what is left of an array fills a
            float64[] row by row.
        index: of the item.
    """
    for name, values in figures.items():
        value = values[index] if index else values
        kind = type(getattr(message, name))
        setattr(message, name, doubles(value) if kind is array else kind(value))


def plan_of(schedule: Any) -> PhasePlan:
    """Read the phases of a satvib_msgs/Schedule.

    Raises:
        SatvibError: an unknown phase, or phases out of order.
    """
    known = {int(phase) for phase in Phase}
    for number in schedule.phases:
        if number not in known:
            raise SatvibError(f'schedule: {number} is not a phase')
    return PhasePlan(
        tuple(Phase(number) for number in schedule.phases),
        tuple(schedule.first_sequence),
        schedule.end_sequence,
    )


def check_period(what: str, period: float, rate: float) -> None:
    """Refuse a message whose sample period differs from that of the node.

    Args:
        what: which message, for the text of the error.
        period: s, as the message says.
        rate: Hz, the parameter `sample_rate`.

    Raises:
        SatvibError: they differ.
    """
    if not abs(period * rate - 1.0) <= 1e-9:
        raise SatvibError(
            f'{what}: sample_period is {period:g} s, but sample_rate {rate:g} Hz means '
            f'{1.0 / rate:g} s; start this node with the rate of the acquisition'
        )
