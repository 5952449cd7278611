# SPDX-FileCopyrightText: 2026 The satvib authors
# SPDX-License-Identifier: Apache-2.0
"""Input and output of a measured record from a text file: read, put in its places in time, looked at."""

from dataclasses import dataclass, field
from pathlib import Path

import numpy as np

from satvib_common.arrays import Array, Mask
from satvib_common.errors import SatvibError
from satvib_common.records.checks import check_signal
from satvib_common.records.encoding import READABLE, TEXT_SUFFIXES, foreign_format
from satvib_common.records.text_table import Reading, TextTable, read_table
from satvib_common.records.time_column import Places, in_order, places, unit_of

BLANK_SHARE = 0.5  # a text with this share of blank rows has them between all rows
MISSING_SHARE = 0.5  # a record with more of its samples missing is refused
PERIOD_TOLERANCE = 0.01


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


def is_text(path: Path, columns_given: bool) -> bool:
    """Whether a file is read as text: by its ending, or because columns were named.

    Raises:
        SatvibError: a file of a known other format, which is named with those that are readable.
    """
    if path.is_dir() or path.suffix.lower() in {'.mcap', '.npz', '.db3'}:
        return False
    if path.suffix.lower() in TEXT_SUFFIXES or columns_given:
        return True
    try:
        with path.open('rb') as source:
            name = foreign_format(source.read(32))
    except OSError:
        name = ''
    if name or (path.is_file() and path.name != 'metadata.yaml'):
        raise SatvibError(
            f'{path}: is {name or "not a format that is known by its ending"}; {READABLE}'
        )
    return False


def text_record(
    path: Path,
    input_column: str | None,
    output_column: str | None,
    period: float | None = None,
    time: str | None = None,
    reading: Reading | None = None,
    memory: int = 200,
) -> MeasuredRecord:
    """Read two columns of a text file and the times of their rows.

    Args:
        path: the file.
        input_column: name or number of the input.
        output_column: name or number of the output.
        period: s; None: as the time column says, and one second where there is none.
        time: name or number of the time column; None: found by its name.
        reading: what is given about the file.
        memory: samples that a model may look back; as many stay empty where two records were glued.

    Raises:
        SatvibError: a column is not named, not there, or holds something else than numbers; times that are none.
    """
    if not input_column or not output_column:
        raise SatvibError(
            f'{path}: name the columns of a text file with --input and --output, by name or by number'
        )
    table = read_table(path, [input_column, output_column], time, reading)
    notes = [*table.notes]
    where = _where(table, path, time is not None, memory, notes)
    u, y = (np.full(where.size, np.nan) for _ in range(2))
    kept = where.place >= 0
    u[where.place[kept]], y[where.place[kept]] = (column[kept] for column in table.columns)
    dt = _sample_period(where, table, period, notes)
    absent = np.isnan(table.columns[0]) | np.isnan(table.columns[1])
    count = int((absent & kept).sum())
    if count:
        first = int(table.lines[np.flatnonzero(absent & kept)[0]])
        notes.append(
            f'{count} rows lack a value ({100.0 * count / len(absent):.2g} %, first at line {first}): gaps; nothing is '
            'taken across them'
        )
        if count > MISSING_SHARE * len(absent):
            raise SatvibError(
                f'{path}: {count} of {len(absent)} rows lack a value; too many for a model'
            )
    notes += check_signal('input', u) + check_signal('output', y)
    return MeasuredRecord(u, y, dt, None, path.name, notes)


def _where(table: TextTable, path: Path, told: bool, memory: int, notes: list[str]) -> Places:
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
        found = places(table.time, values, table.lines, memory, table.time_name)
    except SatvibError as error:
        raise SatvibError(f'{path}: {error}') from None
    notes += found.notes
    return found


def _glued(table: TextTable, memory: int, notes: list[str]) -> Places:
    """Records one after the other, each behind a header of its own."""
    rows = len(table.columns[0])
    extra = np.zeros(rows, dtype=np.int64)
    extra[table.again] = memory
    lines = ', '.join(str(int(table.lines[i])) for i in table.again[:3])
    notes.append(
        f'the header is repeated at line {lines}: what follows is taken as a record of its own'
    )
    place = np.arange(rows) + np.cumsum(extra)
    steps = np.diff(table.time) if table.time is not None else np.zeros(0)
    forward = steps[steps > 0.0]
    return Places(float(np.median(forward)) if len(forward) else 0.0, place, int(place[-1]) + 1)


def _sample_period(where: Places, table: TextTable, told: float | None, notes: list[str]) -> float:
    if not where.period:
        if told is None:
            notes.append('no time column: a sample counts as a second; give --sample-period')
        return told or 1.0
    unit = unit_of(table.time_name)
    found = where.period * (unit or 1.0)
    if told is None:
        assumed = '' if unit else ', taken as seconds'
        notes.append(
            f'sample period {found:.6g} s from the time column {table.time_name!r}{assumed}'
        )
        return found
    if abs(found - told) > PERIOD_TOLERANCE * told:
        notes.append(
            f'the time column {table.time_name!r} advances by {found:.6g} s, --sample-period is {told:.6g} s; that is '
            'used'
        )
    return told
