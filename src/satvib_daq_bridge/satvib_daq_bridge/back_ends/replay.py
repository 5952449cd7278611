# SPDX-FileCopyrightText: 2026 The satvib authors
# SPDX-License-Identifier: Apache-2.0
"""Back end `replay`: a recording instead of sensors; voltages are ignored.

The file has a column for each input (CSV, LVM, TDMS, MAT and the like), or is a bag (its folder or .mcap) with
accelerations. Until a run begins, the first `rest` seconds are played over and over, for the bias; the run begins with
the first row. The end of the record is the end of the run.
"""

from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
from satvib_common.arrays import Array
from satvib_common.errors import SatvibError
from satvib_common.records.any_file import has_columns
from satvib_common.schema import Schema, param

from satvib_daq_bridge.back_ends.base import (
    EndOfRecordError,
    Reading,
    options_of,
)
from satvib_daq_bridge.back_ends.pace.paced import PACES, Paced
from satvib_daq_bridge.back_ends.sensor_file import read_bag, read_file
from satvib_daq_bridge.channels import Channels


@dataclass(frozen=True, kw_only=True)
class Options(Schema):
    """Settings of the replay."""

    file: str = param(description='the record')
    unit: str = param('m/s^2', 'what a file of columns holds', choices=('m/s^2', 'V'))
    columns: dict[str, Any] = param(dict, "column by channel; left out: the channel's own name")
    rest: float = param(1.0, 'how long the rig is at rest at the beginning', unit='s', above=0.0)
    pace: str = param('realtime', 'who keeps the time', choices=PACES)


class Replay(Paced):
    """A recording as a device."""

    def __init__(
        self, channels: Channels, period: float, lifetime: float, options: Options
    ) -> None:
        super().__init__(channels, period, lifetime, options.pace)
        self.options = options
        self.volts = self._read()
        self._rest = max(round(options.rest / period), 1)
        if len(self.volts) < self._rest:
            raise SatvibError(
                f'{options.file}: {len(self.volts)} samples are less than the {options.rest:g} s of rest'
            )
        self._began = -1

    def open(self) -> str:
        """Give the line about what is played."""
        return f'replay: {len(self.volts)} samples of {self.options.file}'

    def poll(self, now: float) -> list[Reading]:
        """Give the next row."""
        due = self.next_sample(now)
        if due is None:
            return []
        index, time, late = due
        self._sequence, self._answered = index, False
        if self._run_begins:
            self._run_begins, self._began = False, index
        row = index % self._rest if self._began < 0 else index - self._began
        if row >= len(self.volts):
            raise EndOfRecordError(f'{self.options.file}: the record is over after {row} samples')
        return [Reading(index, time, self.volts[row], late)]

    def write(self, volts: Array, sequence: int, enable: bool, now: float) -> None:
        """Ignore the voltages; in lockstep the answer of the present sample lets the next one come."""
        del volts, enable, now
        self.answer(sequence)

    def zero(self) -> None:
        """Do nothing: there are no outputs."""

    def _read(self) -> Array:
        names = [name for name, _ in self.channels.inputs]
        path = Path(self.options.file)
        if has_columns(path, columns_given=bool(self.options.columns)):
            columns = {name: str(self.options.columns.get(name, name)) for name in names}
            for name in self.options.columns:
                if name not in names:
                    known = ', '.join(names)
                    raise SatvibError(
                        f'{self.channels.where}: options: columns.{name}: no such channel ({known})'
                    )
            values = read_file(path, columns, self.options.unit)
            if self.options.unit == 'V':
                return values
        else:
            values = read_bag(path, names)
        sensors = [sensor for _, sensor in self.channels.inputs]
        scale = np.array([s.polarity * s.sensitivity for s in sensors])
        return np.array([s.zero_voltage for s in sensors]) + scale * values


def make(channels: Channels, period: float, lifetime: float) -> Replay:
    """Build it."""
    return Replay(channels, period, lifetime, options_of(Options, channels))
