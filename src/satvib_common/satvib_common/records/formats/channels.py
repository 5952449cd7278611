# SPDX-FileCopyrightText: 2026 The satvib authors
# SPDX-License-Identifier: Apache-2.0
"""Channels of a file that is no text: what there is, which are meant, and their table."""

import math
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import numpy as np

from satvib_common.arrays import Array
from satvib_common.errors import SatvibError, printable
from satvib_common.files.suggestions import nearest
from satvib_common.records.table import Table, is_time_name, listed, refuse_same
from satvib_common.records.time_column import unit_of
from satvib_common.records.units import unit_in_name

_RATES = frozenset(
    {
        'fs',
        'samplerate',
        'sampling_rate',
        'samplingrate',
        'sample_rate',
        'sampling_frequency',
        'rate',
    }
)
_PERIODS = frozenset(
    {'ts', 'ta', 'dt', 'sampleperiod', 'sample_period', 'sampling_period', 'delta_t', 'tsample'}
)
_SAME = 1e-9  # relative difference of two sample periods that are the same


@dataclass(frozen=True, kw_only=True)
class Channel:
    """One channel of a file.

    Attributes:
        name: that tells it from all others.
        short: a shorter name that others may have too, such as the name without the group.
        group: what it is in, such as a group of TDMS or a structure of MATLAB.
        size: samples.
        load: gives the samples, (size,), numbers or times; the file must still be open.
        unit: as the file writes it; '' where it does not say.
        period: s; 0 where the file does not say.
        start: s, time of the first sample.
        times: gives the time of each sample, s; None where they are evenly spaced or not known.
        reason: why it is no record of numbers; '' for one that is.
    """

    name: str
    size: int
    load: Callable[[], Any]
    short: str = ''
    group: str = ''
    unit: str = ''
    period: float = 0.0
    start: float = 0.0
    times: Callable[[], Any] | None = None
    reason: str = ''

    @property
    def label(self) -> str:
        """Names, unit and size, for a list."""
        other = '' if self.name.endswith(self.short) else f' "{self.short}"'
        unit = f' [{self.unit}]' if self.unit else ''
        return printable(f'{self.name}{other}{unit} ({self.reason or self.size})', 200)


@dataclass(eq=False)
class Channels:
    """The channels of a file.

    Attributes:
        found: in the order of the file.
        scalars: single numbers by name; one of them may be the sample rate.
        texts: names of what holds text, where the format does not list it among the channels.
        notes: what should be known about the file.
    """

    found: list[Channel]
    scalars: dict[str, float] = field(default_factory=dict)
    texts: list[str] = field(default_factory=list)
    notes: list[str] = field(default_factory=list)

    def table(self, path: Path, wanted: Sequence[str], time: str | None) -> Table:
        """Read channels as a table.

        Args:
            path: of the file, for messages.
            wanted: their names, or their numbers from 1.
            time: name or number of the channel of times; None: found by its name, where there is one.

        Raises:
            SatvibError: no such channel, or channels that do not belong together.
        """
        chosen = [self._channel(path, name) for name in wanted]
        timed = [] if time is None else [self._channel(path, time)]
        asked = [*wanted, *([] if time is None else [time])]
        refuse_same(path, asked, [id(channel) for channel in (*chosen, *timed)])
        _check_together(path, chosen)
        table = Table(
            columns=[numbers(path, c.name, c.load(), c.size) for c in chosen],
            names=[c.name for c in chosen],
            units=[c.unit or unit_in_name(c.name)[1] for c in chosen],
            time=None,
            time_name='',
            time_unit=None,
            period=chosen[0].period,
            again=[],
            lines=np.arange(1.0, chosen[0].size + 1.0),
            row='sample',
            notes=list(self.notes),
        )
        self._add_time(path, table, chosen, time)
        if not table.period and table.time is None:
            table.period = self._stated_period(table, chosen[0].group)
        return table

    def _channel(self, path: Path, name: str) -> Channel:
        """The channel of a name or number."""
        for key in ('name', 'short'):
            same = [c for c in self.found if getattr(c, key) == name]
            same = same or [c for c in self.found if unit_in_name(getattr(c, key))[0] == name]
            if len(same) > 1:
                names = ' or '.join(repr(c.name) for c in same[:10])
                raise SatvibError(
                    f'{path}: the name {name!r} occurs {len(same)} times; give {names}'
                )
            if same:
                return _readable(path, same[0])
        if name.strip().isdecimal():
            if not 1 <= int(name) <= len(self.found):
                raise SatvibError(
                    f'{path}: no channel {int(name)}; there are {len(self.found)}: {self.listed()}'
                )
            return _readable(path, self.found[int(name) - 1])
        for others, what in ((self.texts, 'holds text'), ([*self.scalars], 'is a single number')):
            if any(name in {known, _own(known)} for known in others):
                raise SatvibError(f'{path}: {name} {what}, not a record of numbers')
        raise SatvibError(
            f'{path}: no channel {name!r}; {nearest(name, [c.name for c in self.found])}'
        )

    def listed(self) -> str:
        """List the channels with their numbers."""
        return listed([c.label for c in self.found])

    def _add_time(
        self, path: Path, table: Table, chosen: Sequence[Channel], time: str | None
    ) -> None:
        """Find the times of the rows: the channel that is given, those of a channel itself, or one named as a time."""
        size = chosen[0].size
        if time is not None:
            found = self._channel(path, time)
            if found.size != size:
                raise SatvibError(
                    f'{path}: --time: {found.name} has {found.size} samples, {chosen[0].name} has {size}'
                )
        elif chosen[0].times is not None:
            table.time = numbers(path, f'the times of {chosen[0].name}', chosen[0].times(), size)
            table.time_name, table.time_unit = 'abscissa', 1.0
            return
        else:
            named = [
                c
                for c in self.found
                if c not in chosen
                and c.size == size
                and not c.reason
                and is_time_name(c.short or c.name)
            ]
            same_group = [c for c in named if c.group == chosen[0].group]
            if not named or (chosen[0].period and not same_group):
                return
            found = (same_group or named)[0]
        table.time_name = found.name
        values = found.load()
        table.time = numbers(path, found.name, values, size)
        table.time_unit = unit_of(found.short or found.name) or unit_of(f'({found.unit})')
        if np.asarray(values).dtype.kind in 'mM':
            table.time_unit = 1.0

    def _stated_period(self, table: Table, group: str) -> float:
        """The sample period by a number in the same group, or further out: fs, Ts, sample_rate and the like; s."""
        while True:
            for name, value in self.scalars.items():
                key = name.rpartition('.')[2].lower()
                if _group(name) != group or key not in _RATES | _PERIODS:
                    continue
                what, unit = ('rate', 'Hz') if key in _RATES else ('period', 's')
                if not (value > 0.0 and math.isfinite(value)):
                    table.no_period = f'{name} = {value:.6g} is no sample {what}'
                    return 0.0
                table.notes.append(f'sample {what} {value:.6g} {unit} from {name!r}')
                return 1.0 / value if key in _RATES else value
            if not group:
                return 0.0
            group = _group(group)


def _own(name: str) -> str:
    """A name without what it is in."""
    return name[len(_group(name)) :].lstrip('./')


def _group(name: str) -> str:
    """What a name is in: `run` of `run.u`, `Run 1` of `Run 1/u`."""
    for sign in ('/', '.'):
        if sign in name:
            return name.rpartition(sign)[0]
    return ''


def _readable(path: Path, channel: Channel) -> Channel:
    if channel.reason:
        raise SatvibError(f'{path}: {channel.name}: {channel.reason}')
    return channel


def _check_together(path: Path, chosen: Sequence[Channel]) -> None:
    """Refuse channels of different lengths, sample periods or starts."""
    first = chosen[0]
    for other in chosen[1:]:
        both = f'{path}: {first.name} and {other.name} do not belong together: '
        if other.size != first.size:
            raise SatvibError(f'{both}{first.size} and {other.size} samples')
        if abs(other.period - first.period) > _SAME * max(other.period, first.period):
            raise SatvibError(f'{both}sample periods {first.period:.6g} and {other.period:.6g} s')
        if abs(other.start - first.start) > 0.01 * first.period:
            raise SatvibError(f'{both}they begin {other.start - first.start:.6g} s apart')


def numbers(path: Path, name: str, values: Any, size: int) -> Array:
    """Samples as floats; dates and durations as seconds from the first one.

    Raises:
        SatvibError: they are no numbers, or not as many as the file says.
    """
    array = np.asarray(values)
    if array.size < size:
        raise SatvibError(f'{path}: {name} has {array.size} of {size} samples: the file is cut')
    array = array.reshape(-1)[:size]
    if array.dtype.kind in 'mM':
        missing = np.isnat(array)
        known = array[~missing]
        out = np.full(size, np.nan)
        if len(known):
            out[~missing] = (known - known[0]) / np.timedelta64(1, 's')
        return out
    if array.dtype.kind not in 'buif':
        raise SatvibError(f'{path}: {name} holds {array.dtype}, not numbers')
    out = np.array(array, dtype=np.float64)
    out[~np.isfinite(out)] = np.nan
    return out


def scalars_of(pairs: Mapping[str, Any]) -> dict[str, float]:
    """Keep what is a single number."""
    found = {}
    for name, value in pairs.items():
        try:
            found[name] = float(value)
        except (TypeError, ValueError):
            continue
    return found
