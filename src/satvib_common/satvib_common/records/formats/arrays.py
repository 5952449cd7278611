# SPDX-FileCopyrightText: 2026 The satvib authors
# SPDX-License-Identifier: Apache-2.0
"""Channels of files that hold arrays: an array is one channel, or one for each column of a matrix."""

import functools
import math
from collections.abc import Callable, Sequence
from typing import Any

import numpy as np

from satvib_common.records.formats.channels import Channel

MOST_COLUMNS = 4096  # of one matrix
DEEPEST = 8  # structures in structures
OBJECT = (
    'an object of MATLAB (table, timetable, string): save its columns as arrays, as in '
    "s = table2struct(T, 'ToScalar', true)"
)


def array_channels(
    name: str,
    group: str,
    shape: Sequence[int],
    load: Callable[[], Any],
    *,
    short: str = '',
    unit: str = '',
    reason: str = '',
) -> list[Channel]:
    """Make the channels of an array; the longer side of a matrix is the time.

    Args:
        name: of the array.
        group: that it is in.
        shape: of it; sides of one do not count.
        load: gives the array.
        short: its name without the group.
        unit: of its numbers.
        reason: why it holds no numbers.
    """
    sides = [n for n in shape if n != 1]
    if 0 in shape:
        return []
    if not reason and len(sides) > 2:
        reason = f'an array of {len(sides)} dimensions'
    if not reason and len(sides) == 2 and min(sides) > MOST_COLUMNS:
        reason = f'a matrix of {sides[0]} x {sides[1]}'
    if reason:
        return [Channel(name=name, short=short, size=0, load=list, reason=reason)]
    whole = functools.cache(load)  # one matrix is loaded once for all its columns
    columns = min(sides) if len(sides) == 2 else 0

    def column(i: int) -> Any:
        values = np.asarray(whole()).reshape(sides)
        if not columns:
            return values
        return values[:, i] if sides[0] >= sides[1] else values[i]

    return [
        Channel(
            name=f'{name}:{i + 1}' if columns else name,
            short=f'{short}:{i + 1}' if columns else short,
            group=group,
            size=math.prod(sides) // max(columns, 1),
            load=functools.partial(column, i),
            unit=unit,
        )
        for i in range(columns or 1)
    ]
