# SPDX-FileCopyrightText: 2026 The satvib authors
# SPDX-License-Identifier: Apache-2.0
"""Columns of a measured record from a file of any format: put in their places in time, in V and m/s^2, looked at."""

from collections.abc import Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import NamedTuple

import numpy as np

from satvib_common.arrays import Array, Mask
from satvib_common.errors import SatvibError
from satvib_common.records.any_file import list_columns, read_table
from satvib_common.records.checks import check_signal
from satvib_common.records.layout import Reading
from satvib_common.records.table import Table
from satvib_common.records.time_column import Places, in_order, places
from satvib_common.records.units import ACCELERATION, VOLTAGE, Quantity, plain, scale_of, told_scale

BLANK_SHARE = 0.5  # a text with this share of blank rows has them between all rows
MISSING_SHARE = 0.5  # a record with more of its samples missing is refused
PERIOD_TOLERANCE = 0.01
LONG_PERIOD = 1.0  # s; accelerations are sampled faster, so the times have another unit


class Column(NamedTuple):
    """A column that is asked for.

    Attributes:
        role: what it is to the one who asks, such as 'input'; `--input` is then its option, `--input-unit` that of its
            unit.
        name: of the column, or its number from 1; None where none was given.
        quantity: what it holds; its samples are given in that unit.
        unit: what a person says of it; None: as the file says, and the unit of the quantity where it says nothing.
    """

    role: str
    name: str | None
    quantity: Quantity
    unit: str | None = None


@dataclass(frozen=True, eq=False)
class MeasuredColumns:
    """Columns of a record.

    Attributes:
        values: (columns, samples) in the units of their quantities; NaN where a sample is missing.
        dt: s.
        name: for people.
        notes: what should be known about the record, a line each.
        warnings: what makes every frequency wrong if it is not meant, a line each.
    """

    values: Array
    dt: float
    name: str
    notes: list[str] = field(default_factory=list)
    warnings: list[str] = field(default_factory=list)


@dataclass(frozen=True, eq=False)
class MeasuredRecord:
    """What is identified.

    Attributes:
        u: (samples) input, V; NaN where a sample is missing.
        y: (samples) output, m/s^2; likewise.
        dt: s.
        delay: samples from an input to the first output that it reaches; None where it must be found.
        name: for people.
        notes: what should be known about the record, a line each.
    """

    u: Array
    y: Array
    dt: float
    delay: int | None
    name: str
    notes: list[str] = field(default_factory=list)


def column_record(
    path: Path,
    input_column: str | None,
    output_column: str | None,
    period: float | None = None,
    time: str | None = None,
    reading: Reading | None = None,
    memory: int = 200,
    units: tuple[str | None, str | None] = (None, None),
) -> MeasuredRecord:
    """Read input and output of a file.

    Args:
        path: the file.
        input_column: name or number of the input.
        output_column: name or number of the output.
        period: see `read_columns`, as time, reading and memory.
        time: name or number of the time column.
        reading: what is given about the file.
        memory: samples that a model may look back.
        units: what a person says of the units of input and output.

    Raises:
        SatvibError: see `read_columns`.
    """
    asked = [
        Column('input', input_column, VOLTAGE, units[0]),
        Column('output', output_column, ACCELERATION, units[1]),
    ]
    found = read_columns(path, asked, period, time, reading, memory)
    notes = [*found.warnings, *found.notes]
    return MeasuredRecord(found.values[0], found.values[1], found.dt, None, found.name, notes)


@np.errstate(over='ignore', invalid='ignore')  # damaged bytes may be any number
def read_columns(
    path: Path,
    asked: Sequence[Column],
    period: float | None = None,
    time: str | None = None,
    reading: Reading | None = None,
    memory: int = 200,
) -> MeasuredColumns:
    """Read columns of a file and the times of their rows.

    Args:
        path: the file.
        asked: the columns.
        period: s; None: as the time column says, then as the file says, and one second where neither does.
        time: name or number of the time column; None: found by its name.
        reading: what is given about the file.
        memory: samples that a model may look back; as many stay empty where two records were glued.

    Raises:
        SatvibError: a column is not named, not there, or holds something else than numbers; times that are none; a
            unit that is none; a file that is damaged; a library that is missing.
    """
    wanted = [column.name for column in asked if column.name]
    if len(wanted) < len(asked):
        options = ' and '.join(f'--{column.role}' for column in asked)
        there = list_columns(path, reading)
        raise SatvibError(
            f'{path}: name the columns with {options}, by name or by number'
            + (f'; there are {there}' if there else '; the file has no header line')
        )
    told = [
        None if c.unit is None else told_scale(f'--{c.role}-unit', c.unit, c.quantity)
        for c in asked
    ]
    table = read_table(path, wanted, time, reading)
    notes = [*table.notes]
    where = _where(table, path, time is not None, memory, notes)
    values = np.full((len(asked), where.size), np.nan)
    kept = where.place >= 0
    values[:, where.place[kept]] = np.array(table.columns)[:, kept]
    if table.no_period and period is None and not where.period:
        raise SatvibError(f'{path}: {table.no_period}; give --sample-period')
    warnings: list[str] = []
    dt = _sample_period(where, table, period, notes, warnings)
    _say_missing(table, path, kept, notes)
    _convert(values, asked, told, table, notes)
    for column, samples in zip(asked, values, strict=True):
        notes += check_signal(column.role, samples)
    return MeasuredColumns(values, dt, path.name, notes, warnings)


def _say_missing(table: Table, path: Path, kept: Mask, notes: list[str]) -> None:
    absent: Mask = np.asarray(np.isnan(np.array(table.columns)).any(axis=0))
    count = int((absent & kept).sum())
    if not count:
        return
    first = int(table.lines[np.flatnonzero(absent & kept)[0]])
    rows = 'rows' if table.row == 'line' else 'samples'
    notes.append(
        f'{count} {rows} lack a value ({100.0 * count / len(absent):.2g} %, first at {table.row} {first}): gaps; '
        'nothing is taken across them'
    )
    if count > MISSING_SHARE * len(absent):
        raise SatvibError(
            f'{path}: {count} of {len(absent)} {rows} lack a value; too many for a model'
        )


def _convert(
    values: Array,
    asked: Sequence[Column],
    told: Sequence[float | None],
    table: Table,
    notes: list[str],
) -> None:
    """Put columns into the units of their quantities, in place, and say what was done."""
    silent = []
    for i, (column, scale) in enumerate(zip(asked, told, strict=True)):
        unit = table.units[i] if scale is None else column.unit or ''
        known = plain(unit)
        if scale is None and not known:
            silent.append(column)
            continue
        scale = scale_of(unit, column.quantity) if scale is None else scale
        if scale is None:
            notes.append(
                f'{column.role}: is in {known}, which is no {column.quantity.name}; taken as it is'
            )
        elif scale != 1.0:
            values[i] *= scale
            notes.append(
                f'{column.role}: converted from {unit.strip(" []()")} to {column.quantity.unit}'
            )
    if silent:
        taken = ', '.join(f'{c.role} as {c.quantity.unit}' for c in silent)
        options = ', '.join(f'--{c.role}-unit' for c in silent)
        notes.append(f'units: the file does not say them; taken: {taken} ({options})')


def _where(table: Table, path: Path, told: bool, memory: int, notes: list[str]) -> Places:
    """Where the rows of a table belong: as its times say, or one after the other."""
    rows = len(table.columns[0])
    values = np.array(table.columns)
    blank: Mask = np.asarray(np.isnan(values).all(axis=0))
    if table.time is not None:
        blank &= np.isnan(table.time)
    if blank[1::2].all() and not blank[::2].any() and rows > 2:
        notes.append('every second line is blank; those lines are passed over')
        place = np.full(rows, -1)
        place[~blank] = np.arange(int((~blank).sum()))
        table.time = None if table.time is None else table.time[~blank]
        table.columns = [column[~blank] for column in table.columns]
        table.lines = table.lines[~blank]
        return _where(table, path, told, memory, notes)
    if table.time is None or table.again:
        if table.again:
            return _glued(table, memory, notes)
        return in_order(rows)
    if not told and not np.any(np.diff(table.time[np.isfinite(table.time)]) != 0.0):
        notes.append(f'the time column {table.time_name!r} never changes and is not used')
        return in_order(rows)
    try:
        found = places(table.time, values, table.lines, memory, table.time_name, table.row)
    except SatvibError as error:
        raise SatvibError(f'{path}: {error}') from None
    notes += found.notes
    return found


def _glued(table: Table, memory: int, notes: list[str]) -> Places:
    """Records one after the other, each behind a header of its own."""
    rows = len(table.columns[0])
    extra = np.zeros(rows, dtype=np.int64)
    extra[table.again] = memory
    lines = ', '.join(str(int(table.lines[i])) for i in table.again[:3])
    notes.append(
        f'the header is repeated at {table.row} {lines}: what follows is taken as a record of its own'
    )
    place = np.arange(rows) + np.cumsum(extra)
    steps = np.diff(table.time) if table.time is not None else np.zeros(0)
    forward = steps[steps > 0.0]
    return Places(float(np.median(forward)) if len(forward) else 0.0, place, int(place[-1]) + 1)


def _sample_period(
    where: Places, table: Table, told: float | None, notes: list[str], warnings: list[str]
) -> float:
    """Give the sample period, s: as it is told, else as the times say, else as the file does; say which."""
    unit = table.time_unit
    found = where.period * (unit or 1.0)
    if not found:
        found = table.period
        if told is None and not found:
            warnings.append('no time column: a sample counts as a second; give --sample-period')
        elif told is None:
            _warn_of_long(found, '', warnings)
            notes.append(f'sample period {found:.6g} s, as the file says')
        elif found and abs(found - told) > PERIOD_TOLERANCE * told:
            notes.append(
                f'the file says {found:.6g} s, --sample-period is {told:.6g} s; that is used'
            )
        return told or found or 1.0
    if told is None:
        name = f' (or the unit in the name of the time column, as in {table.time_name} [ms])'
        _warn_of_long(found, '' if unit else name, warnings)
        assumed = '' if unit else ', taken as seconds'
        notes.append(
            f'sample period {found:.6g} s from the time column {table.time_name!r}{assumed}'
        )
        if table.period and abs(found - table.period) > PERIOD_TOLERANCE * found:
            notes.append(f'the file itself says {table.period:.6g} s; the time column is used')
        return found
    if abs(found - told) > PERIOD_TOLERANCE * told:
        notes.append(
            f'the time column {table.time_name!r} advances by {found:.6g} s, --sample-period is {told:.6g} s; that is '
            'used'
        )
    return told


def _warn_of_long(period: float, name: str, warnings: list[str]) -> None:
    """Say that a sample period, s, is too long for accelerations; `name` of what says the unit."""
    if period >= LONG_PERIOD:
        warnings.append(
            f'a sample period of {period:.4g} s is long for accelerations; if the times are in ms, give '
            f'--sample-period {1e-3 * period:.4g}{name}'
        )
