# SPDX-FileCopyrightText: 2026 The satvib authors
# SPDX-License-Identifier: Apache-2.0
"""How a text of numbers is laid out: separator, decimal sign, header line, first row of data.

What is not given is found out from the whole file. Lines that differ in nothing but their digits have one skeleton, so
a million lines are a few dozen skeletons, and each candidate (separator, decimal sign) is tried on those. The best one
makes the most lines rows of numbers of one width.
"""

import csv
import re
from collections import Counter
from collections.abc import Callable, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any, NamedTuple

from satvib_common.errors import SatvibError
from satvib_common.records.units import is_unit

BLANKS = ''  # the separator that is any run of blanks
SEPARATORS = {
    'tab': '\t',
    'semicolon': ';',
    'bar': '|',
    'comma': ',',
    'blanks': BLANKS,
}
MISSING = frozenset({
    '', '-', '--', '?', 'na', 'n/a', '#n/a', 'nan', '-nan', '+nan', '1.#qnan', '-1.#ind', '1.#ind', '1.#nan', 'null',
    'none', 'nil', 'missing', '*', 'nodata', 'no data', 'invalid', '#num!', '#value!', '#div/0!', '-1.#qnan',
    '1,#qnan', '-1,#ind', '1,#ind',
})  # fmt: skip
INFINITE = frozenset({
    'inf', '+inf', '-inf', 'infinity', '-infinity', '+infinity', '1.#inf', '-1.#inf', 'overflow', 'ovf', 'ol',
    '1,#inf', '-1,#inf', '∞', '-∞',
})  # fmt: skip
_NUMBER = {
    '.': re.compile(r'[+-]?(?:[0-9]+\.?[0-9]*|\.[0-9]+)(?:[eEdD][+-]?[0-9]+)?'),
    ',': re.compile(r'[+-]?(?:[0-9]+(?:,[0-9]+)?|,[0-9]+)(?:[eEdD][+-]?[0-9]+)?'),
}
_SKELETONS = 500  # that decide between candidates, the most frequent ones
_RUN = 3  # rows one after the other that are no accident of a preamble
_UNITS = 3  # lines after a header that may hold units or blanks


class Reading(NamedTuple):
    """What is given about a text file; None: found out.

    Attributes:
        separator: a key of SEPARATORS, or the character itself.
        decimal: '.' or ','.
        encoding: as Python names it.
        skip: lines to leave out at the start.
        recover: whether what is left of a file that is cut may be read.
    """

    separator: str | None = None
    decimal: str | None = None
    encoding: str | None = None
    skip: int = 0
    recover: bool = False


@dataclass(frozen=True)
class Layout:
    """Where the numbers of a text are.

    Attributes:
        separator: one character, or BLANKS.
        decimal: '.' or ','.
        header: names of the columns, empty without a header line.
        header_line: index of that line, -1 without one.
        first: index of the first line of data.
        width: cells of a row.
        last_may_lack: whether rows may end before the last column (the comments of LabVIEW).
        units: cells of the row of units under the header; empty without one.
        notes: what was found out and should be known.
    """

    separator: str
    decimal: str
    header: tuple[str, ...]
    header_line: int
    first: int
    width: int
    last_may_lack: bool = False
    units: tuple[str, ...] = ()
    notes: list[str] = field(default_factory=list)

    def name_of(self, position: int) -> str:
        """Name of a column; its number where it has none."""
        if 0 <= position < len(self.header) and self.header[position]:
            return self.header[position]
        return f'column {position + 1}'


def number(cell: str, decimal: str) -> float | None:
    """Read a cell without blanks around it; None where it is no number."""
    if not _NUMBER[decimal].fullmatch(cell):
        return None
    return float(cell.replace(',', '.').replace('d', 'e').replace('D', 'e'))


def split_rows(lines: Sequence[str], separator: str) -> Any:
    """Split lines into cells: a reader of the csv module, or a list for runs of blanks."""
    if separator == BLANKS:
        return [[cell.strip('"') for cell in line.split()] for line in lines]
    return csv.reader(lines, delimiter=separator, skipinitialspace=True)


def cells_of(line: str, separator: str) -> list[str]:
    """Split one line into cells without blanks around them."""
    try:
        return [cell.strip() for cell in next(iter(split_rows([line], separator)), [])]
    except csv.Error:
        return []


def find_layout(
    lines: Sequence[str], path: Path, reading: Reading, names: Callable[[Sequence[str]], bool]
) -> Layout:
    """Find out how a text is laid out.

    Args:
        lines: of the file.
        path: of the file, for messages.
        reading: what is given.
        names: whether the cells of a line are a header with all the columns that are asked for.

    Raises:
        SatvibError: nothing in it is a row of numbers, or a setting that is none.
    """
    start, reading = _preamble(lines, reading)
    lined = lines[start:]
    # digits make no difference to how a line is split
    skeletons = (
        '\n'.join(lined)
        .encode('utf-8', 'surrogatepass')
        .translate(None, b'0123456789')
        .split(b'\n')
    )
    example = dict(zip(reversed(skeletons), reversed(lined), strict=True))
    common = [(example[s], count) for s, count in Counter(skeletons).most_common(_SKELETONS) if s]
    separator, decimal, width = _best(common, path, reading)
    known: dict[bytes, bool] = {
        s: _shape(line, separator, decimal)[2] for s, line in example.items()
    }
    run = _first_run([known[s] for s in skeletons])
    header_line = next(
        (i for i in range(run - 1, -1, -1) if names(cells_of(lined[i], separator))), -1
    )
    if header_line < 0:
        above = [i for i in range(run - 1, max(run - 1 - _UNITS, -1), -1) if lined[i].strip()]
        header_line = next((i for i in above if len(cells_of(lined[i], separator)) >= width > 1
                            or (width == 1 and not known[skeletons[i]])), -1)  # fmt: skip
        higher = [i for i in above if 0 <= i < header_line]
        if higher and _is_units(lined[header_line], separator):
            wide = len(cells_of(lined[higher[0]], separator)) >= width
            header_line = higher[0] if wide else header_line
    notes: list[str] = []
    if header_line < 0:
        return Layout(separator, decimal, (), -1, start + run, width, notes=notes)
    header = cells_of(lined[header_line], separator)
    while header and not header[-1]:
        header.pop()
    first, units = _after_units(lined, header_line, known, skeletons, separator, notes, start)
    return Layout(
        separator,
        decimal,
        tuple(header),
        start + header_line,
        start + first,
        len(header),
        units=units,
        notes=notes,
    )


def _preamble(lines: Sequence[str], reading: Reading) -> tuple[int, Reading]:
    """First line to look at, and what the first lines say about the others."""
    start = reading.skip
    if start >= len(lines):
        return len(lines), reading
    if lines[start].strip().strip('"').lower().startswith('sep='):  # as Excel writes it
        told = lines[start].strip().strip('"')[4:]
        return start + 1, reading._replace(separator=reading.separator or told or None)
    return start, reading


def _shape(line: str, separator: str, decimal: str) -> tuple[int, int, bool]:
    """Cells, numbers, and whether at least half of a line are numbers or marks of missing ones."""
    cells = cells_of(line, separator)
    while cells and not cells[-1]:
        cells.pop()
    numbers = sum(1 for cell in cells if _NUMBER[decimal].fullmatch(cell))
    marks = sum(1 for cell in cells if cell.lower() in MISSING or cell.lower() in INFINITE)
    return len(cells), numbers, numbers >= 1 and 2 * (numbers + marks) >= len(cells)


def _best(common: list[tuple[str, int]], path: Path, reading: Reading) -> tuple[str, str, int]:
    """Separator, decimal sign and width that make the most lines rows of numbers."""
    if reading.decimal not in {None, '.', ','}:
        raise SatvibError(f"--decimal: {reading.decimal!r} is not '.' or ','")
    separators = list(SEPARATORS.values())
    if reading.separator is not None:
        told = SEPARATORS.get(reading.separator, reading.separator.replace('\\t', '\t'))
        if told == ' ':
            told = BLANKS
        if len(told) > 1 or (told and (told.isalnum() or told in '"+-.\n\r')):
            raise SatvibError(
                f'--separator: {reading.separator!r} is not one character or one of {", ".join(SEPARATORS)}'
            )
        separators = [told]
    best, choice = (0, 0.0, 0), (BLANKS, '.', 0)
    for separator in separators:
        for decimal in [reading.decimal] if reading.decimal else ['.', ',']:
            if separator == decimal:
                continue
            widths: Counter[int] = Counter()
            cells = numbers = 0
            for line, count in common:
                width, here, good = _shape(line, separator, decimal)
                if good:
                    widths[width] += count
                    cells += count * width
                    numbers += count * here
            if widths:
                width, rows = widths.most_common(1)[0]
                score = (rows, round(numbers / cells, 3), numbers)
                if score > best:
                    best, choice = score, (separator, decimal, width)
    if not best[0]:
        raise SatvibError(
            f'{path}: no data: no line is a row of numbers; give --separator, --decimal and --skip'
        )
    return choice


def _first_run(flags: list[bool]) -> int:
    """Start of the first run of rows that is long enough, or else of the first one."""
    length = 0
    for i, flag in enumerate(flags):
        length = length + 1 if flag else 0
        if length == _RUN:
            return i - _RUN + 1
    return flags.index(True)


def _is_units(line: str, separator: str) -> bool:
    """Whether a line has units in its cells and nothing else."""
    cells = [cell for cell in cells_of(line, separator) if cell.strip('-')]
    return bool(cells) and all(is_unit(cell) for cell in cells)


def _after_units(
    lines: Sequence[str],
    header: int,
    known: dict[bytes, bool],
    skeletons: list[bytes],
    separator: str,
    notes: list[str],
    start: int,
) -> tuple[int, tuple[str, ...]]:
    """First line after a header that may be data, and the cells of the first row of units before it."""
    first = header + 1
    units: tuple[str, ...] = ()
    while first < len(lines) and first <= header + _UNITS and not known[skeletons[first]]:
        if lines[first].strip():
            units = units or tuple(cells_of(lines[first], separator))
            notes.append(
                f'line {start + first + 1} holds no numbers and was taken for units: {lines[first].strip()[:60]}'
            )
        first += 1
    return first, units
