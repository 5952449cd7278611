# SPDX-FileCopyrightText: 2026 The satvib authors
# SPDX-License-Identifier: Apache-2.0
"""Back end `serial`: a microcontroller that speaks docs/serial_protocol.md.

The device owns the time. Its clock is mapped to the host's by the fastest frames: the least delay seen so far, allowed
to drift by `_DRIFT`, so that a stall of the host shows as lateness and not as a shifted sample.

Writing never waits: while an older frame is still unsent, a newer command is given up, and the lifetime at the device
decides.
"""

import math
import os
import select
import time
from dataclasses import dataclass
from typing import Any

import numpy as np
from satvib_common.arrays import Array
from satvib_common.errors import SatvibError
from satvib_common.schema import Schema, param

from satvib_daq_bridge.back_ends.base import (
    BackEnd,
    BackEndError,
    Reading,
    check_indices,
    options_of,
    single_device,
)
from satvib_daq_bridge.back_ends.serial_port import Port
from satvib_daq_bridge.channels import Channel, Channels
from satvib_daq_bridge.protocol import messages
from satvib_daq_bridge.protocol.framing import FrameReader

_DRIFT = 2e-4  # of the clocks against each other, generously
_MICRO = 1e6
_LARGEST = 2**31 - 1  # uV, what a message holds
# samples by which the numbers may be ahead of the host's clock, and the share by which the device's clock may be faster
_AHEAD, _FASTER = 50.0, 1.001
# damaged numbers in a row that make a fault: then the device, not the line, is wrong
_IMPLAUSIBLE_LIMIT = 10


@dataclass(frozen=True, kw_only=True)
class Options(Schema):
    """Settings of the serial port."""

    baud: int = param(2_000_000, 'rate of a UART; a native USB port ignores it', minimum=9600)
    hold: str = param('linear', 'output between commands', choices=('zero', 'linear'))
    patience: float = param(3.0, 'longest wait for the device to answer', unit='s', above=0.0)


class Serial(BackEnd):
    """One microcontroller on one port."""

    def __init__(
        self, channels: Channels, period: float, lifetime: float, options: Options
    ) -> None:
        super().__init__(channels, period, lifetime)
        self.options = options
        self.path = single_device(channels)
        self._inputs = np.array([c.index for _, c in channels.inputs])
        self._outputs = np.array([c.index for _, c in channels.outputs])
        self._port = Port(self.path, options.baud)
        self._reader = FrameReader()
        self._session = 0
        self._number = 0
        self._identity: messages.Identity | None = None
        self._sequence = -1
        self._device_time = 0
        self._offset = math.inf
        self._last_sample_at = 0.0
        self._enabled = False
        self._reported: messages.Sample | None = None
        self.given_up = 0
        self.lost = 0
        self.implausible = 0
        self._implausible_run = 0
        self._possible = _AHEAD
        self._heard_at = 0.0

    def open(self) -> str:
        """Open the port, put the device to 0 V and read its identity."""
        self._port.open()
        # a zero byte ends a frame that an earlier writer left unfinished
        self._port.send_all(b'\0' + messages.to_wire(messages.Zero()))
        asked = int.from_bytes(os.urandom(4), 'little')
        found = self._ask(
            messages.Hello(0, asked),
            lambda m: isinstance(m, messages.Identity) and m.number == asked,
        )
        assert isinstance(found, messages.Identity)
        self._check_identity(found)
        self._identity = found
        return f'{found.name} on {self.path}: {found.inputs} inputs, {found.outputs} outputs'

    def start(self, now: float) -> None:
        """Begin a session."""
        assert self._identity is not None
        self._session = 1 + int.from_bytes(os.urandom(2), 'little') % 0xFFFF
        limits = [0] * self._identity.outputs
        for _, coil in self.channels.outputs:
            limits[coil.index] = min(math.ceil(coil.limit / coil.gain * _MICRO), _LARGEST)
        setup = messages.Configure(
            self._session,
            1,
            round(self.period * 1e9),
            round(self.lifetime * _MICRO),
            messages.Hold[self.options.hold.upper()],
            self._identity.inputs,
            tuple(limits),
        )
        session = self._session
        answer = self._ask(
            setup,
            lambda m: isinstance(m, messages.Configured) and m.session == session and m.number == 1,
        )
        assert isinstance(answer, messages.Configured)
        if answer.refusal is not messages.Refusal.NONE:
            raise SatvibError(
                f'{self.path}: the device refuses the set-up ({answer.refusal.name.lower()}): period '
                f'{self.period:g} s, lifetime {self.lifetime:g} s; its shortest period is '
                f'{self._identity.shortest_period / 1e9:g} s'
            )
        self._number = 0
        self._sequence = -1
        self._offset = math.inf
        self._device_time = 0
        self._last_sample_at = self._heard_at = now
        self._possible = _AHEAD

    def fileno(self) -> int:
        """The port."""
        return self._port.fileno()

    def poll(self, now: float) -> list[Reading]:
        """Give the samples that have arrived."""
        self._port.flush()
        readings = []
        for message in self._receive():
            if isinstance(message, messages.Sample) and message.session == self._session:
                reading = self._reading(message, now)
                if reading is not None:
                    readings.append(reading)
        return readings

    def write(self, volts: Array, sequence: int, enable: bool, now: float) -> None:
        """Send one command."""
        del now
        assert self._identity is not None
        values = [0] * self._identity.outputs
        for index, value in zip(self._outputs, volts, strict=True):
            values[index] = max(-_LARGEST, min(round(float(value) * _MICRO), _LARGEST))
        self._number = (self._number + 1) & 0xFFFFFFFF
        command = messages.Command(
            self._session, self._number, sequence & 0xFFFFFFFF, enable, tuple(values)
        )
        self._enabled = enable
        self.given_up += not self._port.offer(messages.to_wire(command))

    def zero(self) -> None:
        """Send ZERO, which needs no session."""
        if not self._port.is_open:
            return
        self._enabled = False
        try:
            self._port.send_all(b'\0' + messages.to_wire(messages.Zero()), patience=0.05)
        except (BackEndError, SatvibError):
            return

    def close(self) -> None:
        """End the session and close the port."""
        if not self._port.is_open:
            return
        try:
            self._port.send_all(b'\0' + messages.to_wire(messages.Stop()), patience=0.05)
        except (BackEndError, SatvibError):
            pass
        finally:
            self._port.close()

    def figures(self) -> dict[str, float]:
        """Counts of the port and of the device."""
        reported = self._reported
        return {
            'frames': float(self._reader.accepted),
            'frames rejected': float(self._reader.rejected),
            'samples lost': float(self.lost),
            'samples with an impossible number': float(self.implausible),
            'commands given up': float(self.given_up),
            'rejected by device': float(reported.rejected if reported else 0),
            'refused by device': float(reported.refused if reported else 0),
            'dropped by device': float(reported.dropped if reported else 0),
        }

    def _reading(self, message: messages.Sample, now: float) -> Reading | None:
        """Bring a sample into the host's count and time; None for one that is not newer."""
        assert self._identity is not None
        if len(message.inputs) != self._identity.inputs:
            return None
        if self._sequence >= 0 and not messages.newer(message.number, self._sequence & 0xFFFFFFFF):
            return None
        if not self._plausible(message, now):
            return None
        before = self._sequence
        self._sequence += (message.number - self._sequence) & 0xFFFFFFFF
        self.lost += self._sequence - before - 1
        self._device_time += (message.time - self._device_time) & 0xFFFFFFFF
        taken = self._device_time / _MICRO
        # the fastest frame defines the offset; it may rise only as fast as clocks drift
        self._offset = min(
            now - taken, self._offset + _DRIFT * max(now - self._last_sample_at, 0.0)
        )
        self._last_sample_at = now
        self._reported = message
        fault = ''
        if messages.Flag.EXPIRED in message.flags and self._enabled:
            fault = 'the device had no command within its lifetime and is at 0 V'
        if messages.Flag.OPENED in message.flags and self._enabled:
            fault = 'the enable chain is open'
        volts = np.array(message.inputs, dtype=float)[self._inputs] / _MICRO
        when = taken + self._offset
        return Reading(self._sequence, when, volts, now - when, fault)

    def _plausible(self, message: messages.Sample, now: float) -> bool:
        """Whether the device can have taken so many samples since the session began.

        The time that has passed gives samples that are possible, and each sample uses what it is ahead of the last one.

        Raises:
            BackEndError: it says so again and again.
        """
        ahead = (message.number - self._sequence) & 0xFFFFFFFF
        self._possible += max(now - self._heard_at, 0.0) / self.period * _FASTER
        self._heard_at = now
        if ahead <= self._possible:
            self._possible -= ahead
            self._implausible_run = 0
            return True
        self.implausible += 1
        self._implausible_run += 1
        if self._implausible_run >= _IMPLAUSIBLE_LIMIT:
            raise BackEndError(
                f'{self.path}: the device numbers its samples wrongly: {message.number} after '
                f'{self._sequence & 0xFFFFFFFF}'
            )
        return False

    def _check_identity(self, found: messages.Identity) -> None:
        if found.version != messages.VERSION:
            raise SatvibError(
                f'{self.path}: the device speaks version {found.version} of the protocol, this is '
                f'version {messages.VERSION}; load the matching firmware'
            )
        where = self.channels.where
        check_indices(where, self.channels.inputs, found.inputs, 'input')
        check_indices(where, self.channels.outputs, found.outputs, 'output')
        for named, low, high in (
            (self.channels.inputs, found.input_low, found.input_high),
            (self.channels.outputs, found.output_low, found.output_high),
        ):
            for name, channel in named:
                self._check_range(name, channel, low / _MICRO, high / _MICRO)

    def _check_range(self, name: str, channel: Channel, low: float, high: float) -> None:
        if max(abs(channel.range[0] - low), abs(channel.range[1] - high)) > 1e-3 * (high - low):
            raise SatvibError(
                f'{self.channels.where}: {name}.range: {channel.range[0]:g} to {channel.range[1]:g} V, '
                f'but the device says {low:g} to {high:g} V'
            )

    def _ask(self, question: messages.Message, is_answer: Any) -> messages.Message:
        """Send a question until its answer comes."""
        deadline = time.monotonic() + self.options.patience
        while time.monotonic() < deadline:
            self._port.send_all(messages.to_wire(question))
            again = time.monotonic() + 0.25
            while time.monotonic() < again:
                select.select([self.fileno()], [], [], 0.05)
                for message in self._receive():
                    if is_answer(message):
                        return message
        raise SatvibError(
            f'{self.path}: no satvib device answers within {self.options.patience:g} s '
            f'({self._reader.rejected} broken frames seen); is it this port, the right firmware and rate?'
        )

    def _receive(self) -> list[messages.Message]:
        return messages.read_stream(self._reader, self._port.read())


def make(channels: Channels, period: float, lifetime: float) -> Serial:
    """Build it."""
    return Serial(channels, period, lifetime, options_of(Options, channels))
