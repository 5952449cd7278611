# SPDX-FileCopyrightText: 2026 The satvib authors
# SPDX-License-Identifier: Apache-2.0
"""Back end `comedi`: boards with a Linux comedi driver, such as the paper's own PCI-6025E.

A device is /dev/comedi0 and so on; three struts need two boards of the paper's kind. The host keeps the time: every
period all inputs are read one after the other, and outputs are written as soon as their voltages are there. A comedi
output holds its last value without end, also when its writer was killed (measured: 7 V stayed). The guardian puts the
outputs to 0 V. When guardian and bridge are killed together, only hardware can.
"""

import ctypes
from dataclasses import dataclass
from functools import partial
from typing import Any

import numpy as np
from satvib_common.arrays import Array
from satvib_common.errors import SatvibError
from satvib_common.schema import Schema, param

from satvib_daq_bridge.back_ends.base import BackEndError, options_of
from satvib_daq_bridge.back_ends.comedi_library import AI, AO, REFERENCES, UNIT_VOLT, Comedi
from satvib_daq_bridge.back_ends.pace.polled import Polled
from satvib_daq_bridge.channels import Channel, Channels


@dataclass(frozen=True, kw_only=True)
class Options(Schema):
    """Settings of comedi."""

    reference: str = param(
        'ground', 'what the inputs are measured against', choices=tuple(REFERENCES)
    )
    library: str = param('', 'path of libcomedi.so; empty: where the system has it')


@dataclass(frozen=True)
class _Opened:
    """One channel, ready to be read or written."""

    name: str
    handle: Any
    subdevice: int
    channel: int
    range_index: int
    range: Any
    maxdata: int


class ComediBoards(Polled):
    """One or more comedi devices."""

    def __init__(
        self, channels: Channels, period: float, lifetime: float, options: Options
    ) -> None:
        super().__init__(channels, period, lifetime)
        self._library = Comedi(options.library)
        self._reference = REFERENCES[options.reference]
        self._handles: dict[str, Any] = {}
        self._locked: list[tuple[Any, int]] = []
        self._inputs: list[_Opened] = []
        self._outputs: list[_Opened] = []

    def open(self) -> str:
        """Open the devices, find every channel and its range, and write 0 V."""
        try:
            self._outputs = [self._find(n, c, AO) for n, c in self.channels.outputs]
            self.writers = [partial(self._put, i) for i in range(len(self._outputs))]
            self._lock()
            self.write(np.zeros(len(self._outputs)), 0, False, 0.0)
            self._inputs = [self._find(n, c, AI) for n, c in self.channels.inputs]
        except BackEndError as error:
            raise SatvibError(str(error)) from None
        boards = {
            device: self._library.call('comedi_get_board_name', handle)
            for device, handle in self._handles.items()
        }
        named = [f'{(b or b"").decode()} on {device}' for device, b in boards.items()]
        return f'comedi: {", ".join(named)}'

    def read(self) -> Array:
        """Read one input after the other."""
        return np.array([self._read(opened) for opened in self._inputs])

    def close(self) -> None:
        """Unlock and close."""
        for handle, subdevice in self._locked:
            self._library.call('comedi_unlock', handle, subdevice)
        self._locked.clear()
        for handle in self._handles.values():
            self._library.call('comedi_close', handle)
        self._handles.clear()
        self._inputs, self._outputs, self.writers = [], [], []

    def _find(self, name: str, channel: Channel, kind: int) -> _Opened:
        library, where = self._library, f'{self.channels.where}: {name}'
        handle = self._handle(channel.device)
        what = 'inputs' if kind == AI else 'outputs'
        subdevice = library.call('comedi_find_subdevice_by_type', handle, kind, 0)
        if subdevice < 0:
            raise SatvibError(f'{where}: {channel.device} has no analog {what}')
        count = library.checked(where, 'comedi_get_n_channels', handle, subdevice)
        if channel.index >= count:
            raise SatvibError(
                f'{where}: {channel.device} has {count} analog {what}, no channel {channel.index}'
            )
        low, high = channel.range
        index = library.call(
            'comedi_find_range', handle, subdevice, channel.index, UNIT_VOLT, low, high
        )
        if index < 0:
            raise SatvibError(
                f'{where}: {channel.device} has no range of {low:g} to {high:g} V on this channel'
            )
        limits = library.checked(where, 'comedi_get_range', handle, subdevice, channel.index, index)
        maxdata = library.call('comedi_get_maxdata', handle, subdevice, channel.index)
        if maxdata == 0:
            raise SatvibError(f'{where}: comedi_get_maxdata: {library.error()}')
        if channel.bits and maxdata + 1 != 2**channel.bits:
            raise SatvibError(
                f'{where}: bits: {channel.bits}, but the converter has codes from 0 to {maxdata}'
            )
        return _Opened(name, handle, subdevice, channel.index, index, limits, maxdata)

    def _handle(self, device: str) -> Any:
        if device not in self._handles:
            handle = self._library.call('comedi_open', device.encode())
            if not handle:
                raise SatvibError(
                    f'{device}: comedi_open: {self._library.error()}; is the board there and its '
                    "driver loaded (comedi_config), and are you in the group 'iocard'?"
                )
            self._handles[device] = handle
        return self._handles[device]

    def _lock(self) -> None:
        """Keep other programs from the outputs."""
        for handle, subdevice in {(opened.handle, opened.subdevice) for opened in self._outputs}:
            device = next(d for d, h in self._handles.items() if h == handle)
            self._library.checked(device, 'comedi_lock', handle, subdevice)
            self._locked.append((handle, subdevice))

    def _read(self, opened: _Opened) -> float:
        data = ctypes.c_uint()
        self._library.checked(
            opened.name, 'comedi_data_read', opened.handle, opened.subdevice, opened.channel,
            opened.range_index, self._reference, ctypes.byref(data),
        )  # fmt: skip
        return float(self._library.call('comedi_to_phys', data.value, opened.range, opened.maxdata))

    def _put(self, position: int, volts: Array) -> None:
        opened = self._outputs[position]
        code = self._library.call(
            'comedi_from_phys', float(volts[position]), opened.range, opened.maxdata
        )
        self._library.checked(
            opened.name, 'comedi_data_write', opened.handle, opened.subdevice, opened.channel,
            opened.range_index, REFERENCES['ground'], code,
        )  # fmt: skip


def make(channels: Channels, period: float, lifetime: float) -> ComediBoards:
    """Build it."""
    return ComediBoards(channels, period, lifetime, options_of(Options, channels))
