# SPDX-FileCopyrightText: 2026 The satvib authors
# SPDX-License-Identifier: Apache-2.0
"""What a back end is: the one interface between the guardian and the converters.

All voltages are at the converters' terminals; inputs and outputs are in the order of `Channels`. A back end decides
nothing: the output guard has checked what it writes.
"""

import math
from abc import ABC, abstractmethod
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any, TypeVar

from satvib_common.arrays import Array
from satvib_common.errors import SatvibError
from satvib_common.schema import Schema

from satvib_daq_bridge.channels import Channel, Channels

S = TypeVar('S', bound=Schema)


class BackEndError(Exception):
    """A device fails while it runs; the message is one line."""


class EndOfRecordError(BackEndError):
    """Nothing is left to read: the recording that is played has ended."""


@dataclass(frozen=True)
class Reading:
    """One sample of all inputs.

    Attributes:
        sequence: index of the sample since `start`; a gap is a lost sample.
        time: s of the monotonic clock, when it was taken, as exactly as that is known.
        volts: (inputs) V at the terminals.
        late: s, how much later than its time it was there.
        fault: the fault that the device reports; empty without one.
    """

    sequence: int
    time: float
    volts: Array
    late: float = 0.0
    fault: str = ''


class BackEnd(ABC):
    """Devices with converters.

    Args:
        channels: all channels.
        period: s, sample period.
        lifetime: s, how long a device with a watchdog of its own keeps a command.

    Attributes:
        virtual: there is no clock; sample k + 1 comes when sample k has been answered, and time is k periods.
    """

    virtual = False

    def __init__(self, channels: Channels, period: float, lifetime: float) -> None:
        self.channels, self.period, self.lifetime = channels, period, lifetime

    @abstractmethod
    def open(self) -> str:
        """Connect, put every output to 0 V, and give one line about what was found.

        Raises:
            SatvibError: a fault in channels, options or wiring that a person must correct.
        """

    @abstractmethod
    def start(self, now: float) -> None:
        """Begin to sample, with sample 0 next."""

    def begin_run(self) -> None:  # noqa: B027 - most have nothing to do
        """Take note that the next sample is the first of an experiment; simulations begin their disturbance."""

    def fileno(self) -> int:
        """A descriptor that becomes readable when there is something to poll; -1: none."""
        return -1

    def due(self) -> float:
        """When `poll` has something to do by the clock, s of the monotonic clock."""
        return math.inf

    @abstractmethod
    def poll(self, now: float) -> list[Reading]:
        """Give the samples that are there; never waits.

        Raises:
            BackEndError: the device fails or is gone.
        """

    @abstractmethod
    def write(self, volts: Array, sequence: int, enable: bool, now: float) -> None:
        """Set the outputs (outputs, V), computed from a sample; `enable` is whether the bridge is ACTIVE.

        Raises:
            BackEndError: the device fails or is gone.
        """

    @abstractmethod
    def zero(self) -> None:
        """Put every output to 0 V by every means there is; never raises."""

    @abstractmethod
    def close(self) -> None:
        """Close the devices; never raises."""

    def figures(self) -> dict[str, float]:
        """Counts for people."""
        return {}


def options_of(schema: type[S], channels: Channels) -> S:
    """Check the options of a back end.

    Raises:
        SatvibError: a wrong key or value; the message names the file.
    """
    return schema.from_mapping(channels.options, f'{channels.where}: options')


def single_device(channels: Channels) -> str:
    """Give the one device of all channels.

    Raises:
        SatvibError: there is more than one.
    """
    named = [*channels.inputs, *channels.outputs]
    first_name, first = named[0]
    for name, channel in named:
        if channel.device != first.device:
            raise SatvibError(
                f'{channels.where}: {name}: device {channel.device}, but {first_name} is on '
                f'{first.device}; back end {channels.back_end} drives one device'
            )
    return first.device


def check_indices(where: str, named: Sequence[tuple[str, Channel]], count: int, what: str) -> None:
    """Refuse a channel that the device does not have.

    Raises:
        SatvibError: the message names the channel.
    """
    for name, channel in named:
        if channel.index >= count:
            raise SatvibError(
                f'{where}: {name}: {what} {channel.index} of {channel.device} does not exist, '
                f'it has {count} (0 to {count - 1})'
            )


def missing_library(back_end: str, library: str, command: str) -> SatvibError:
    """Make the error for a library that is not installed, with the command that installs it."""
    return SatvibError(f'back end {back_end}: {library} is missing; install it with: {command}')


def by_device(named: Sequence[tuple[str, Channel]]) -> Mapping[str, list[tuple[int, Any]]]:
    """Group channels by device: (position, channel) in the order given."""
    groups: dict[str, list[tuple[int, Any]]] = {}
    for position, (_, channel) in enumerate(named):
        groups.setdefault(channel.device, []).append((position, channel))
    return groups
