# SPDX-FileCopyrightText: 2026 The satvib authors
# SPDX-License-Identifier: Apache-2.0
"""Back end `iio`: Linux Industrial I/O converters through libiio, here or on another machine (option `uri`).

A device is the name or the id of an IIO device (`ad7606`, `iio:device0`); input and output i are its channels
`voltage<i>`. The host keeps the time and reads and writes the attribute `raw`:

    volts = (raw + offset) scale / 1000      scale is in mV per count, as the kernel says

An IIO output holds its last value without end, as a comedi output does.
"""

import contextlib
import math
from collections.abc import Iterator
from dataclasses import dataclass
from functools import partial
from typing import Any

import numpy as np
from satvib_common.arrays import Array
from satvib_common.errors import SatvibError
from satvib_common.schema import Schema, param

from satvib_daq_bridge.back_ends.base import (
    BackEndError,
    missing_library,
    options_of,
)
from satvib_daq_bridge.back_ends.pace.polled import Polled
from satvib_daq_bridge.channels import Channel, Channels


@dataclass(frozen=True, kw_only=True)
class Options(Schema):
    """Settings of libiio."""

    uri: str = param('local:', 'where the devices are: local:, ip:192.168.2.1, usb:')
    patience: float = param(0.1, 'longest answer once samples flow', unit='s', minimum=0.001)


@dataclass(frozen=True)
class _Opened:
    """One channel: its attribute `raw`, and what a count means."""

    name: str
    raw: Any
    offset: float
    scale: float

    def volts(self) -> float:
        return (float(self.raw.value) + self.offset) * self.scale

    def set(self, volts: float) -> None:
        self.raw.value = str(math.floor(volts / self.scale - self.offset + 0.5))


class IioDevices(Polled):
    """Devices of one IIO context."""

    def __init__(
        self, channels: Channels, period: float, lifetime: float, options: Options
    ) -> None:
        super().__init__(channels, period, lifetime)
        try:
            import iio
        except ImportError:
            raise missing_library('iio', 'pylibiio', "pip install 'pylibiio<1'") from None
        except (OSError, AttributeError, TypeError):
            # the bindings are there, the library that they bind is not
            raise missing_library('iio', 'libiio', 'apt install libiio0') from None
        self._library = iio
        self.options = options
        self._context: Any = None
        self._inputs: list[_Opened] = []
        self._outputs: list[_Opened] = []

    def open(self) -> str:
        """Find every channel; outputs first, at 0 V."""
        try:
            self._context = self._library.Context(self.options.uri)
        except OSError as error:
            raise SatvibError(
                f'iio: {self.options.uri}: {error.strerror or error}; is the device there, and iiod '
                'running on it?'
            ) from None
        try:
            self._outputs = [self._find(n, c, output=True) for n, c in self.channels.outputs]
            self.writers = [partial(self._put, i) for i in range(len(self._outputs))]
            self.write(np.zeros(len(self._outputs)), 0, False, 0.0)
            self._inputs = [self._find(n, c, output=False) for n, c in self.channels.inputs]
        except BackEndError as error:
            raise SatvibError(str(error)) from None
        devices = sorted({c.device for _, c in (*self.channels.inputs, *self.channels.outputs)})
        return f'iio: {", ".join(devices)} at {self.options.uri}'

    def start(self, now: float) -> None:
        """Start the clock; from now on each call has the short timeout."""
        self._context.set_timeout(round(self.options.patience * 1e3))
        super().start(now)

    def read(self) -> Array:
        """Read one input after the other."""
        volts = np.empty(len(self._inputs))
        for i, opened in enumerate(self._inputs):
            with _library_errors(opened.name, 'read'):
                volts[i] = opened.volts()
        return volts

    def close(self) -> None:
        """Close the context."""
        self._inputs, self._outputs, self.writers = [], [], []
        self._context = None

    def _put(self, position: int, volts: Array) -> None:
        opened = self._outputs[position]
        with _library_errors(opened.name, 'write'):
            opened.set(float(volts[position]))

    def _find(self, name: str, channel: Channel, output: bool) -> _Opened:
        where = f'{self.channels.where}: {name}'
        device = self._context.find_device(channel.device)
        if device is None:
            known = ', '.join(d.name or d.id for d in self._context.devices) or 'none'
            raise SatvibError(f'{where}: no IIO device {channel.device} (devices: {known})')
        found = device.find_channel(f'voltage{channel.index}', output)
        kind = 'output' if output else 'input'
        if found is None:
            raise SatvibError(f'{where}: {channel.device} has no {kind} voltage{channel.index}')
        for attribute in ('raw', 'scale'):
            if attribute not in found.attrs:
                raise SatvibError(
                    f'{where}: {kind} voltage{channel.index} has no attribute {attribute!r}'
                )
        with _library_errors(where, 'read'):
            offset = float(found.attrs['offset'].value) if 'offset' in found.attrs else 0.0
            scale = float(found.attrs['scale'].value) / 1e3
        if not (math.isfinite(scale) and scale > 0.0 and math.isfinite(offset)):
            raise SatvibError(f'{where}: scale {scale:g} V and offset {offset:g} make no sense')
        if channel.step and abs(scale / channel.step - 1.0) > 0.01:
            raise SatvibError(
                f'{where}: bits: range and bits mean {channel.step:g} V a count, the device says '
                f'{scale:g} V'
            )
        return _Opened(name, found.attrs['raw'], offset, scale)


@contextlib.contextmanager
def _library_errors(where: str, what: str) -> Iterator[None]:
    """Turn the library's errors into one line."""
    try:
        yield
    except (OSError, ValueError) as error:
        said = getattr(error, 'strerror', None) or str(error)
        raise BackEndError(f'iio: {where}: {what}: {said}') from None


def make(channels: Channels, period: float, lifetime: float) -> IioDevices:
    """Build it."""
    return IioDevices(channels, period, lifetime, options_of(Options, channels))
