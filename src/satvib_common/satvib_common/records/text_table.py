# SPDX-FileCopyrightText: 2026 The satvib authors
# SPDX-License-Identifier: Apache-2.0
"""Columns of numbers from a text file: by name or by number, with what is missing as NaN.

A row must have as many cells as the header has names: a decimal comma between commas would otherwise shift all that
follows. A cell that is neither a number nor a mark for a missing value is refused with its line.
"""

import csv
import math
import re
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, field
from datetime import datetime
from itertools import islice
from operator import itemgetter
from pathlib import Path

import numpy as np

from satvib_common.arrays import Array
from satvib_common.errors import SatvibError
from satvib_common.files.suggestions import nearest
from satvib_common.records.encoding import decode
from satvib_common.records.layout import (
    INFINITE,
    MISSING,
    Layout,
    Reading,
    cells_of,
    find_layout,
    number,
    split_rows,
)

_BLOCK = 50_000  # rows converted at once
_TIME = re.compile(
    r'(?:time|zeit|temps|tiempo|tempo|timestamp|time ?stamp|sampling_time|x_value|elapsed|t|seconds|date ?time)'
    r'(?:[ _]*[\[\(/_ ] ?(?:ns|us|µs|μs|ms|s|sec|secs|seconds|min|h|sample|samples)[\]\)]?)?',
    re.IGNORECASE,
)
_CLOCK = re.compile(r'(?:([0-9]+):)?([0-9]{1,2}):([0-9]{1,2}(?:[.,][0-9]+)?)')


@dataclass(eq=False)
class TextTable:
    """What a text file holds.

    Attributes:
        columns: one array (rows,) per column asked for; NaN where a value is missing.
        time: (rows,) the time column, in its own unit; None without one.
        time_name: its name.
        again: rows at which the header is repeated, so that another record begins.
        lines: (rows,) line of each row, from 1.
        notes: what should be known about the reading.
    """

    columns: list[Array]
    time: Array | None
    time_name: str
    again: list[int]
    lines: Array
    notes: list[str] = field(default_factory=list)


def read_table(
    path: Path, wanted: Sequence[str], time: str | None = None, reading: Reading | None = None
) -> TextTable:
    """Read columns of a text file.

    Args:
        path: the file.
        wanted: names of columns in the header, or their numbers from 1.
        time: name or number of the time column; None: found by its name, where there is one.
        reading: what is given about the file; the rest is found out.

    Raises:
        SatvibError: no such file or column, a name that occurs twice, rows with more or fewer cells than the header, a
            cell that is no number; the line is named.
    """
    reading = reading or Reading()
    try:
        data = path.read_bytes()
    except OSError as error:
        raise SatvibError(f'{path}: cannot be read: {error.strerror}') from None
    text, encoding = decode(data, path, reading.encoding)
    del data
    if not text.strip():
        raise SatvibError(f'{path}: is empty; a header line with column names is expected')
    lines = text.split('\n')
    cut = lines.pop() if lines[-1].strip() and len(lines) > 3 else ''
    del text
    asked = [*wanted, *([time] if time is not None else [])]
    by_name = [name for name in asked if not name.strip().isdecimal()]
    layout = find_layout(
        lines, path, reading, lambda cells: bool(by_name) and set(by_name) <= set(cells)
    )
    positions = [_position(name, layout, path) for name in asked]
    at = positions.pop() if time is not None else _time_position(layout, positions)
    reader = _Rows(path, lines, layout, [*positions, *([at] if at >= 0 else [])])
    columns = reader.read(at >= 0)
    if cut:  # a number may have lost its exponent
        layout.notes.append('the last line has no line end, so it may be cut, and is left out')
    if encoding not in {'utf-8', 'utf-8-sig', reading.encoding}:
        layout.notes.append(f'read as {encoding}')
    if layout.decimal == ',' and reading.decimal is None:
        layout.notes.append('read with decimal commas')
    if reader.infinite:
        layout.notes.append(f'{reader.infinite} values are infinite and count as missing')
    stamps = columns.pop() if at >= 0 else None
    name = layout.header[at] if 0 <= at < len(layout.header) else f'column {at + 1}'
    return TextTable(columns, stamps, name, reader.again, reader.lines, layout.notes)


def _position(name: str, layout: Layout, path: Path) -> int:
    """Index of a column."""
    found = [i for i, known in enumerate(layout.header) if known == name]
    if len(found) > 1:
        places = ' and '.join(str(i + 1) for i in found)
        raise SatvibError(
            f'{path}: line {layout.header_line + 1}: the name {name!r} occurs {len(found)} times; give the '
            'number of the '
            f'column instead, {places}'
        )
    if found:
        return found[0]
    if name.strip().isdecimal():
        if not 1 <= int(name) <= layout.width:
            raise SatvibError(f'{path}: no column {int(name)}; there are {layout.width}')
        return int(name) - 1
    if not layout.header:
        raise SatvibError(
            f'{path}: no column {name!r}: there is no header line; give columns by number, 1 to {layout.width}'
        )
    raise SatvibError(f'{path}: no column {name!r}; {nearest(name, layout.header)}')


def _time_position(layout: Layout, taken: Sequence[int]) -> int:
    """Index of the one column that is named as a time, -1 without one."""
    found = [
        i
        for i, name in enumerate(layout.header)
        if i not in taken and _TIME.fullmatch(name.strip())
    ]
    return found[0] if found else -1


class _Rows:
    """The rows of a text, converted block by block.

    Args:
        path: of the file, for messages.
        lines: of the file.
        layout: of them.
        positions: of the columns to read.
    """

    def __init__(self, path: Path, lines: list[str], layout: Layout, positions: list[int]) -> None:
        self._path, self._source, self._layout = path, lines[layout.first :], layout
        while self._source and not self._source[-1].strip():
            self._source.pop()
        self._positions = positions
        self._names = [
            layout.header[i] if i < len(layout.header) and layout.header[i] else f'column {i + 1}'
            for i in positions
        ]
        self.again: list[int] = []
        self.infinite = 0
        self.lines: Array = np.zeros(0)

    def read(self, with_time: bool) -> list[Array]:
        """Give the columns; the last one is a time where `with_time`.

        Raises:
            SatvibError: see `read_table`.
        """
        rows = 0
        blocks: list[list[Array]] = []
        source = iter(split_rows(self._source, self._layout.separator))
        for block in self._blocks(source):
            widths = set(map(len, block))
            if not widths <= {self._layout.width, 0}:
                for row, cells in enumerate(block):
                    self._check_width(cells, rows + row)
            columns = []
            for i, position in enumerate(self._positions):
                timed = with_time and i == len(self._positions) - 1
                columns.append(self._column(block, position, self._names[i], rows, timed))
            blocks.append(columns)
            rows += len(block)
        if not rows:
            raise SatvibError(f'{self._path}: no data after the header line')
        self.lines = np.arange(rows, dtype=np.float64) + (self._layout.first + 1.0)
        return [np.concatenate(parts) for parts in zip(*blocks, strict=True)]

    def _blocks(self, source: Iterator[list[str]]) -> Iterator[list[list[str]]]:
        try:
            while block := list(islice(source, _BLOCK)):
                yield block
        except csv.Error as error:
            raise SatvibError(f'{self._path}: cannot be read: {error}') from None

    def _line(self, row: int) -> int:
        """Line of a row, from 1; a quoted cell may span lines, so the rows are counted again."""
        source = split_rows(self._source, self._layout.separator)
        if isinstance(source, list):
            return self._layout.first + row + 1
        for _ in islice(source, row):
            pass
        return self._layout.first + source.line_num + 1

    def _check_width(self, cells: list[str], row: int) -> None:
        """Refuse a row that has more or fewer cells than the header; empty cells at its end do not count."""
        width = len(cells)
        expected = self._layout.width
        if width in {0, expected} or (self._layout.last_may_lack and width == expected - 1):
            return
        if width > expected and not any(cell.strip() for cell in cells[expected:]):
            return
        if not any(cell.strip() for cell in cells):
            return
        what = f'the header {expected}' if self._layout.header else f'the first row {expected}'
        hint = ''
        if width > expected and self._layout.separator == ',':
            hint = '; decimal commas between commas cannot be told apart: export with another separator'
        raise SatvibError(
            f'{self._path}: line {self._line(row)}: the row has {width} cells, {what}{hint}'
        )

    def _column(
        self, block: list[list[str]], position: int, name: str, rows: int, timed: bool
    ) -> Array:
        if min(map(len, block)) > position:
            cells = list(map(itemgetter(position), block))
        else:
            cells = [row[position] if position < len(row) else '' for row in block]
        joined = '\n'.join(cells)
        comma = self._layout.decimal == ','
        # float() reads more than a file should hold: 1_000, other scripts' digits, points among decimal commas
        if '_' not in joined and not (comma and '.' in joined) and joined.isascii():
            try:
                values = np.array(
                    [float(c.replace(',', '.')) for c in cells]
                    if comma
                    else list(map(float, cells))
                )
            except ValueError:
                values = np.full(1, np.nan)
            if np.isfinite(values).all():
                return values
        return np.array(
            [self._cell(text, block[i], name, rows + i, timed) for i, text in enumerate(cells)]
        )

    def _cell(self, text: str, row: list[str], name: str, at: int, timed: bool) -> float:
        text = text.strip()
        value = number(text, self._layout.decimal)
        if value is not None and math.isfinite(value):
            return value
        if value is not None or text.lower() in INFINITE:
            self.infinite += 1
            return math.nan
        if text.lower() in MISSING:
            return math.nan
        if timed and (stamp := seconds(text)) is not None:
            return stamp
        if self._layout.header and self._repeats_header(row):
            if at not in self.again:
                self.again.append(at)
            return math.nan
        raise SatvibError(
            f'{self._path}: line {self._line(at)}: {name} is {text[:60]!r}, not a number'
        )

    def _repeats_header(self, row: list[str]) -> bool:
        cells = [cell.strip() for cell in row]
        while cells and not cells[-1]:
            cells.pop()
        return tuple(cells) == self._layout.header


def seconds(text: str) -> float | None:
    """Read a date with a time of day (ISO 8601), or a time of day h:m:s, as seconds; None where it is neither."""
    if clock := _CLOCK.fullmatch(text):
        hours, minutes, rest = clock.groups()
        return 3600.0 * float(hours or 0) + 60.0 * float(minutes) + float(rest.replace(',', '.'))
    try:
        return (
            datetime.fromisoformat(text).replace(tzinfo=None) - datetime(1970, 1, 1)
        ).total_seconds()
    except ValueError:
        return None


__all__ = ['Reading', 'TextTable', 'cells_of', 'read_table', 'seconds']
