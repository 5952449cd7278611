# SPDX-FileCopyrightText: 2026 The satvib authors
# SPDX-License-Identifier: Apache-2.0
"""Columns of numbers from a text file: by name or by number, with what is missing as NaN.

A row must have as many cells as the header has names: a decimal comma between commas would otherwise shift all that
follows. A cell that is neither a number nor a mark for a missing value is refused with its line.
"""

from collections.abc import Callable, Sequence
from pathlib import Path
from typing import NamedTuple

from satvib_common.errors import SatvibError
from satvib_common.files.suggestions import nearest
from satvib_common.records.encoding import decode
from satvib_common.records.layout import Layout, Reading, find_layout
from satvib_common.records.table import Table, is_time_name, refuse_same
from satvib_common.records.text_rows import Rows
from satvib_common.records.time_column import unit_of
from satvib_common.records.units import unit_in_name


class Text(NamedTuple):
    """The lines of a text file.

    Attributes:
        lines: without their ends; a last line that has none, and may be cut, is not among them.
        cut: whether there was such a line.
        encoding: of the file.
    """

    lines: list[str]
    cut: bool
    encoding: str


def read_text(
    path: Path, wanted: Sequence[str], time: str | None = None, reading: Reading | None = None
) -> Table:
    """Read columns of a text file.

    Args:
        path: the file.
        wanted: names of columns in the header, with their unit or without, or their numbers from 1.
        time: name or number of the time column; None: found by its name, where there is one.
        reading: what is given about the file; the rest is found out.

    Raises:
        SatvibError: no such file or column, a name that occurs twice, rows with more or fewer cells than the header, a
            cell that is no number; the line is named.
    """
    reading = reading or Reading()
    text = read_lines(path, reading)
    layout = find_layout(
        text.lines, path, reading, _named([*wanted, *([time] if time is not None else [])])
    )
    table = read_rows(path, text.lines, layout, wanted, time)
    return finish(table, text, layout, reading)


def read_lines(path: Path, reading: Reading) -> Text:
    """Read the lines of a text file.

    Raises:
        SatvibError: it cannot be read, is no text, or empty.
    """
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
    return Text(lines, bool(cut), encoding)


def list_text(path: Path, reading: Reading | None = None) -> list[str]:
    """Name the columns of a text file; empty where it has no header line.

    Raises:
        SatvibError: see `read_text`.
    """
    reading = reading or Reading()
    return list(find_layout(read_lines(path, reading).lines, path, reading, _named([])).header)


def read_rows(
    path: Path, lines: list[str], layout: Layout, wanted: Sequence[str], time: str | None
) -> Table:
    """Read columns of lines whose layout is known; arguments and errors as of `read_text`."""
    asked = [*wanted, *([time] if time is not None else [])]
    positions = [position_of(name, layout, path) for name in asked]
    refuse_same(path, asked, positions)
    at = positions.pop() if time is not None else _time_position(layout, positions)
    reader = Rows(path, lines, layout, [*positions, *([at] if at >= 0 else [])])
    columns = reader.read(at >= 0)
    if reader.infinite:
        layout.notes.append(f'{reader.infinite} values are infinite and count as missing')
    stamps = columns.pop() if at >= 0 else None
    names = [layout.name_of(i) for i in positions]
    name = layout.name_of(at)
    return Table(
        columns=columns,
        names=names,
        units=[_unit(layout, i) for i in positions],
        time=stamps,
        time_name=name,
        time_unit=unit_of(name),
        period=0.0,
        again=reader.again,
        lines=reader.lines,
        notes=layout.notes,
    )


def finish(table: Table, text: Text, layout: Layout, reading: Reading) -> Table:
    """Say what was found out about a text that was read."""
    if text.cut:  # a number may have lost its exponent
        table.notes.append('the last line has no line end, so it may be cut, and is left out')
    if text.encoding not in {'utf-8', 'utf-8-sig', reading.encoding}:
        table.notes.append(f'read as {text.encoding}')
    if layout.decimal == ',' and reading.decimal is None:
        table.notes.append('read with decimal commas')
    return table


def _named(asked: Sequence[str]) -> Callable[[Sequence[str]], bool]:
    """Whether the cells of a line are a header with all the names that are asked for."""
    by_name = {name for name in asked if not name.strip().isdecimal()}

    def is_header(cells: Sequence[str]) -> bool:
        return bool(by_name) and by_name <= {*cells, *(unit_in_name(cell)[0] for cell in cells)}

    return is_header


def _unit(layout: Layout, position: int) -> str:
    """The unit of a column: from the row of units, or from its name."""
    if position < len(layout.units) and layout.units[position]:
        return layout.units[position]
    return unit_in_name(layout.header[position])[1] if position < len(layout.header) else ''


def position_of(name: str, layout: Layout, path: Path) -> int:
    """Index of a column, by its name with or without unit, or by its number.

    Raises:
        SatvibError: there is none, or more than one.
    """
    found = [i for i, known in enumerate(layout.header) if known == name]
    found = found or [i for i, known in enumerate(layout.header) if unit_in_name(known)[0] == name]
    if len(found) > 1:
        places = ' and '.join(str(i + 1) for i in found)
        raise SatvibError(
            f'{path}: line {layout.header_line + 1}: the name {name!r} occurs {len(found)} times; give the '
            f'number of the column instead, {places}'
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
    found = [i for i, name in enumerate(layout.header) if i not in taken and is_time_name(name)]
    return found[0] if found else -1


__all__ = [
    'Reading',
    'Text',
    'finish',
    'list_text',
    'position_of',
    'read_lines',
    'read_rows',
    'read_text',
]
