# SPDX-FileCopyrightText: 2026 The satvib authors
# SPDX-License-Identifier: Apache-2.0
"""LabVIEW measurement files (.lvm): a text with two headers, or with one more for every segment of the record.

An own reader: the library lvm_read evaluates what a file holds as Python code, leaves a pickle beside the file and
reads one that lies there, and makes NaN of every cell that it does not know. The numbers here are read as those of any
text, so a wrong cell is refused with its line.

Source: National Instruments, Specification for the LabVIEW Measurement File (.lvm), 2010. The cell of a key in the
header of a segment stands above the column that it is about. `X_Columns` says whether there is one column of times, one
per channel, or none; `Delta_X` is the sample period.
"""

from collections.abc import Sequence
from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np

from satvib_common.errors import SatvibError
from satvib_common.records.layout import Layout, Reading, cells_of, find_layout, number
from satvib_common.records.table import Table
from satvib_common.records.text_table import Text, finish, position_of, read_lines, read_rows

START = 'LabVIEW Measurement'
_END = '***End_of_Header***'
_SEPARATORS = {'Tab': '\t', 'Comma': ','}
_MOST_BEFORE = 12  # lines of a segment's header before `Channels`


@dataclass(frozen=True)
class _Segment:
    """One segment of a file.

    Attributes:
        labels: index of the line with the names of the columns.
        end: index behind its last line of data.
        keys: cells of its header by key; cell i is about column i.
    """

    labels: int
    end: int
    keys: dict[str, list[str]]

    def cell(self, key: str, column: int) -> str:
        """What the header says about a column; '' for nothing."""
        cells = self.keys.get(key, [])
        return cells[column] if 0 <= column < len(cells) else ''


def read_labview(
    path: Path, wanted: Sequence[str], time: str | None = None, reading: Reading | None = None
) -> Table:
    """Read channels of a LabVIEW file.

    Args:
        path: the file.
        wanted: names of channels, or their numbers from 1 as `list_labview` gives them.
        time: name or number of the time column; None: as `X_Columns` says.
        reading: what is given about the file; what its header says comes after it.

    Raises:
        SatvibError: no such channel, a header that is cut, a channel over something else than time, a cell that is no
            number; the line is named.
    """
    text, reading, keys = _opened(path, reading or Reading())
    tables, layouts = [], []
    for segment in _segments(path, text.lines, reading):
        layout = _layout(path, text.lines, segment, reading)
        layouts.append(layout)
        tables.append(
            _segment_table(path, text.lines, segment, layout, wanted, time, reading, keys)
        )
    table = _joined(path, tables)
    return finish(table, text, layouts[0], reading)


def list_labview(path: Path, reading: Reading | None = None) -> list[str]:
    """Name the columns of the first segment.

    Raises:
        SatvibError: see `read_labview`.
    """
    text, reading, _ = _opened(path, reading or Reading())
    segment = _segments(path, text.lines, reading)[0]
    names = cells_of(text.lines[segment.labels], reading.separator or '\t')
    units = [segment.cell('Y_Unit_Label', i) for i in range(len(names))]
    units[:1] = ['']  # the name of the key
    return [f'{name} [{u}]' if u else name for name, u in zip(names, units, strict=True)]


def _opened(path: Path, reading: Reading) -> tuple[Text, Reading, dict[str, str]]:
    """The lines, what is known about them, and the header of the file."""
    text = read_lines(path, reading)
    keys: dict[str, str] = {}
    for line in text.lines:
        if line.startswith(_END):
            break
        key, _, value = line.partition('\t' if '\t' in line else ',')
        keys.setdefault(key.strip(), value.strip(' \t'))
    separator = reading.separator or _SEPARATORS.get(keys.get('Separator', ''))
    told = keys.get('Decimal_Separator', '')[:1]
    if not told and separator == ',':
        told = '.'
    decimal = reading.decimal or (told if told in {'.', ','} else None)
    return text, reading._replace(separator=separator, decimal=decimal), keys


def _segments(path: Path, lines: Sequence[str], reading: Reading) -> list[_Segment]:
    """Find the segments: each has a header that ends, a line of names, and rows."""
    separator = reading.separator or '\t'
    ends = [i for i, line in enumerate(lines) if line.startswith(_END)]
    if len(ends) > 1:  # the first one ends the header of the file
        ends = ends[1:]
    if not ends:
        raise SatvibError(f'{path}: a LabVIEW file without {_END}: it is cut in its header')
    found = []
    for number_of, at in enumerate(ends):
        labels = next((i for i in range(at + 1, len(lines)) if lines[i].strip()), -1)
        if labels < 0:
            raise SatvibError(f'{path}: line {at + 1}: no data after the header; the file is cut')
        begins = _header_start(lines, ends[number_of - 1] + 2 if number_of else 1, at)
        keys: dict[str, list[str]] = {}
        for line in lines[begins:at]:
            cells = cells_of(line, separator)
            if cells and cells[0]:
                keys.setdefault(cells[0], cells)
        behind = len(lines)
        if number_of + 1 < len(ends):
            behind = _header_start(lines, labels + 1, ends[number_of + 1])
        found.append(_Segment(labels, behind, keys))
    return found


def _header_start(lines: Sequence[str], first: int, end: int) -> int:
    """Index of the first line of the segment's header that ends at `end`."""
    channels = next(
        (i for i in range(end - 1, first - 1, -1) if lines[i].startswith('Channels')), end
    )
    for i in range(channels - 1, max(first - 1, channels - _MOST_BEFORE), -1):
        if not lines[i].strip():
            return i
    return channels


def _layout(path: Path, lines: list[str], segment: _Segment, reading: Reading) -> Layout:
    names = set(cells_of(lines[segment.labels], reading.separator or '\t'))
    layout = find_layout(
        lines[: segment.end],
        path,
        reading._replace(skip=segment.labels),
        lambda cells: set(cells) == names,
    )
    # the last column holds comments, which most rows lack
    return replace(layout, last_may_lack=True)


def _segment_table(
    path: Path,
    lines: list[str],
    segment: _Segment,
    layout: Layout,
    wanted: Sequence[str],
    time: str | None,
    reading: Reading,
    keys: dict[str, str],
) -> Table:
    """One segment as a table, with its units and its sample period."""
    chosen = [position_of(name, layout, path) for name in wanted]
    at, columns = time, keys.get('X_Columns')
    if time is None and columns == 'Multi' and chosen and chosen[0] > 0:
        at = str(chosen[0])  # the times of a channel stand before it
    if time is None and columns == 'No':
        layout = replace(layout, header=('', *layout.header[1:]))
    table = read_rows(path, lines[: segment.end], layout, wanted, at)
    _check_samples(path, table, segment, chosen, reading)
    for i, column in enumerate(chosen):
        dimension = segment.cell('X_Dimension', column)
        if dimension and dimension != 'Time':
            raise SatvibError(
                f'{path}: {table.names[i]} is over {dimension}, not over time (X_Dimension)'
            )
        table.units[i] = segment.cell('Y_Unit_Label', column) or table.units[i]
    periods = [_number(segment.cell('Delta_X', column), layout) for column in chosen]
    if len(set(periods)) > 1:
        raise SatvibError(
            f'{path}: {" and ".join(table.names)} have different sample periods (Delta_X), '
            f'{" and ".join(f"{p:.6g}" for p in periods)} s'
        )
    table.period = max(periods, default=0.0)
    if table.time is not None:
        table.time_unit = table.time_unit or 1.0
    elif table.period > 0.0:
        start = _number(segment.cell('X0', chosen[0]), layout)
        table.time = np.asarray(start + table.period * np.arange(len(table.columns[0])))
        table.time_name, table.time_unit = 'Delta_X', 1.0
    return table


def _check_samples(
    path: Path, table: Table, segment: _Segment, chosen: list[int], reading: Reading
) -> None:
    """Refuse a segment that holds fewer rows than its header says; more is a record that went on.

    Raises:
        SatvibError: the file is cut.
    """
    for name, column in zip(table.names, chosen, strict=True):
        said = segment.cell('Samples', column)
        there = len(table.lines)
        if said.isdecimal() and there < int(said):
            what = f'{name} has {there} of the {int(said)} samples that its header states: the file is cut'
            if not reading.recover:
                raise SatvibError(f'{path}: {what}; --recover reads what is there')
            table.notes.append(what)


def _number(cell: str, layout: Layout) -> float:
    """A number of the header; 0 where there is none. Old writers have a point there whatever the rows have."""
    for decimal in (layout.decimal, '.', ','):
        value = number(cell.strip(), decimal)
        if value is not None:
            return value
    return 0.0


def _joined(path: Path, tables: list[Table]) -> Table:
    """The segments one after the other: as one record where their times go on, else as records of their own."""
    first = tables[0]
    if len(tables) == 1:
        return first
    if any((t.time is None) != (first.time is None) or t.period != first.period for t in tables):
        raise SatvibError(f'{path}: its {len(tables)} segments have different sample periods')
    sizes = np.cumsum([len(t.lines) for t in tables])[:-1]
    whole = replace(
        first,
        columns=[np.concatenate(parts) for parts in zip(*(t.columns for t in tables), strict=True)],
        time=None if first.time is None else np.concatenate([t.time for t in tables]),
        lines=np.concatenate([t.lines for t in tables]),
        notes=[*dict.fromkeys(note for t in tables for note in t.notes)],
    )
    goes_on = whole.time is not None and all(whole.time[i] > whole.time[i - 1] for i in sizes)
    whole.again = [] if goes_on else [int(i) for i in sizes]
    return whole
