# SPDX-FileCopyrightText: 2026 The satvib authors
# SPDX-License-Identifier: Apache-2.0
"""The columns of a record as every reader gives them, whatever the file was."""

import re
from collections.abc import Sequence
from dataclasses import dataclass, field
from pathlib import Path

from satvib_common.arrays import Array
from satvib_common.errors import SatvibError

_TIME = re.compile(
    r'(?:time|zeit|temps|tiempo|tempo|timestamp|time ?stamp|sampling_time|x_value|elapsed|t|seconds|date ?time)'
    r'(?:[ _]*[\[\(/_ ] ?(?:ns|us|µs|μs|ms|s|sec|secs|seconds|min|h|sample|samples)[\]\)]?)?',
    re.IGNORECASE,
)
_MOST_LISTED = 40


@dataclass(eq=False)
class Table:
    """Columns of a file.

    Attributes:
        columns: one array (rows,) per column asked for, as the file has it; NaN where a value is missing.
        names: of them.
        units: of them, as the file writes them; '' where it does not say.
        time: (rows,) the time column, in its own unit; None without one.
        time_name: its name.
        time_unit: s; None where the file does not say.
        period: s, the sample period that the file states; 0 where it states none.
        again: rows at which another record begins (the header is repeated).
        lines: (rows,) number of each row, from 1: the line of a text, the sample of any other file.
        row: what `lines` counts, 'line' or 'sample', for messages.
        notes: what should be known about the reading.
        no_period: what the file gives for a sample period or rate and is none, in words.
    """

    columns: list[Array]
    names: list[str]
    units: list[str]
    time: Array | None
    time_name: str
    time_unit: float | None
    period: float
    again: list[int]
    lines: Array
    row: str = 'line'
    notes: list[str] = field(default_factory=list)
    no_period: str = ''


def is_time_name(name: str) -> bool:
    """Whether a column is named as a time: time, t, Zeit, X_Value ..., with a unit or without."""
    return _TIME.fullmatch(name.strip()) is not None


def refuse_same(path: Path, asked: Sequence[str], places: Sequence[int]) -> None:
    """Refuse columns of which two are the same one: an output is no response to itself.

    Args:
        path: of the file.
        asked: names or numbers as they were given.
        places: where each was found.

    Raises:
        SatvibError: naming the two.
    """
    first: dict[int, str] = {}
    for name, place in zip(asked, places, strict=True):
        if place in first:
            other = first[place]
            what = (
                f'{name!r} is named twice' if name == other else f'{other!r} and {name!r} are one'
            )
            raise SatvibError(f'{path}: column {what}; input, output and time differ')
        first[place] = name


def listed(names: Sequence[str]) -> str:
    """List columns with their numbers, at most 40."""
    text = ', '.join(f'{i + 1} {name}' for i, name in enumerate(names[:_MOST_LISTED]))
    more = len(names) - _MOST_LISTED
    return f'{text} and {more} more' if more > 0 else text
