# SPDX-FileCopyrightText: 2026 The satvib authors
# SPDX-License-Identifier: Apache-2.0
"""Columns of numbers from a CSV file with a header line."""

import csv
import math
from collections.abc import Sequence
from pathlib import Path
from typing import TextIO

import numpy as np

from satvib_common.arrays import Array
from satvib_common.errors import SatvibError
from satvib_common.files.suggestions import nearest


def read_columns(path: Path, names: Sequence[str]) -> list[Array]:
    """Read columns by their names in the header.

    Args:
        path: the file; separated by commas, semicolons or tabs.
        names: of the columns.

    Returns:
        One array (rows,) per name.

    Raises:
        SatvibError: no such file, empty, no such column, a cell that is no finite number; the line is named.
    """
    try:
        with path.open(encoding='utf-8-sig', newline='') as source:
            return _read(source, path, names)
    except (OSError, UnicodeDecodeError, csv.Error) as error:
        reason = error.strerror if isinstance(error, OSError) else error
        raise SatvibError(f'{path}: cannot be read as CSV: {reason}') from None


def _read(source: TextIO, path: Path, names: Sequence[str]) -> list[Array]:
    first = source.readline()
    if not first.strip():
        raise SatvibError(f'{path}: is empty; a header line with column names is expected')
    delimiter = max(',;\t', key=first.count)
    header = [name.strip() for name in next(csv.reader([first], delimiter=delimiter))]
    positions = []
    for name in names:
        if name not in header:
            raise SatvibError(f'{path}: no column {name!r}; {nearest(name, header)}')
        positions.append(header.index(name))
    values: list[list[float]] = [[] for _ in names]
    for row in (reader := csv.reader(source, delimiter=delimiter)):
        if not row or not any(cell.strip() for cell in row):
            continue
        line = reader.line_num + 1
        for column, position, name in zip(values, positions, names, strict=True):
            if position >= len(row):
                raise SatvibError(f'{path}: line {line}: {name} is missing')
            column.append(_number(row[position], path, line, name))
    if not values[0]:
        raise SatvibError(f'{path}: no data after the header line')
    return [np.array(column) for column in values]


def _number(text: str, path: Path, line: int, name: str) -> float:
    try:
        value = float(text)
    except ValueError:
        raise SatvibError(f'{path}: line {line}: {name} is {text!r}, not a number') from None
    if not math.isfinite(value):
        raise SatvibError(f'{path}: line {line}: {name} is {text.strip()}, not a finite number')
    return value
