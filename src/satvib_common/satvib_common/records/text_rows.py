# SPDX-FileCopyrightText: 2026 The satvib authors
# SPDX-License-Identifier: Apache-2.0
"""The rows of a text whose layout is known, as numbers: fast where all is well, with the line where it is not."""

import csv
import math
import re
from collections.abc import Iterator
from datetime import datetime
from itertools import islice
from operator import itemgetter
from pathlib import Path

import numpy as np

from satvib_common.arrays import Array
from satvib_common.errors import SatvibError
from satvib_common.records.layout import INFINITE, MISSING, Layout, number, split_rows

_BLOCK = 50_000  # rows converted at once
_CLOCK = re.compile(r'(?:([0-9]+):)?([0-9]{1,2}):([0-9]{1,2}(?:[.,][0-9]+)?)')


class Rows:
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
        self._names = [layout.name_of(i) for i in positions]
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
