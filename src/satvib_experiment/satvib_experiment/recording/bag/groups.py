# SPDX-FileCopyrightText: 2026 The satvib authors
# SPDX-License-Identifier: Apache-2.0
"""Messages of the struts as arrays by sample and strut, within what the number of messages justifies."""

import dataclasses
from collections import Counter
from typing import Any

import numpy as np
from numpy.typing import NDArray
from satvib_common.arrays import Integers
from satvib_common.errors import SatvibError

from satvib_experiment.recording.recording import Group

MOST_PER_MESSAGE = 20  # samples from first to last; a recording that lost more of them is none
# where a message belongs, and how it is packed
_SKIPPED = frozenset({
    'header', 'sequence', 'next_sequence', 'samples', 'strokes', 'stroke_peaks', 'force_peaks',
    'currents',
})  # fmt: skip
_LONGEST_TEXT = 256  # characters of a reason that are kept
_WIDE = 256  # elements of a list that any sample may have
_SPARE = 1_000_000  # elements of an array that any file may ask for


def group_arrays(
    by_strut: list[list[Any]], first: int, count: int, group: str, counts: Counter[str]
) -> Group:
    """Turn the struts' messages of one type into arrays by sample; none when no message is of a recorded sample.

    Of a recorder that was killed the topics end at different samples: some of its messages are of samples whose
    accelerations are not in the bag.

    Args:
        by_strut: messages of each strut; a strut may have none.
        first, count: the samples of the recording.
        group: its name.
        counts: what is repeated or outside is added here.

    Raises:
        SatvibError: lists that no recording has.
    """
    present = np.zeros((count, len(by_strut)), dtype=bool)
    names: list[str] = []
    kept: list[list[Any]] = []
    rows: list[Integers] = []
    for strut, messages in enumerate(by_strut):
        inside = [m for m in messages if 0 <= m.sequence - first < count]
        by_row = {m.sequence - first: m for m in inside}
        counts[f'{group}_repeated'] += len(inside) - len(by_row)
        counts[f'{group}_outside_of_the_recording'] += len(messages) - len(inside)
        order = sorted(by_row)
        rows.append(np.array(order, dtype=np.int64))
        kept.append([by_row[k] for k in order])
        present[rows[-1], strut] = True
        if inside and not names:
            names = [f.name for f in dataclasses.fields(inside[0]) if f.name not in _SKIPPED]
            names = [n for n in names if not n.startswith('_')]
    if not names:
        return {}
    result: Group = {
        name: _array([[getattr(m, name) for m in messages] for messages in kept], rows, count)
        for name in names
    }
    result['present'] = present
    return result


def _array(values: list[list[Any]], rows: list[Integers], count: int) -> NDArray[Any]:
    """Scatter values by strut to (count, struts, ...); NaN, zero or '' where there is none."""
    filled = [v for v in values if v]
    sample = filled[0][0]
    if isinstance(sample, str):
        width = min(max(len(text) for column in filled for text in column), _LONGEST_TEXT)
        result: NDArray[Any] = np.zeros((count, len(values)), dtype=f'U{max(width, 1)}')
    elif isinstance(sample, np.ndarray):
        width = max(len(item) for column in filled for item in column)
        given = sum(len(item) for column in filled for item in column)
        # models come in some phases only, and there are not more samples than accelerations justify
        justified = max(2 * MOST_PER_MESSAGE * given, _WIDE * count)
        if count * len(values) * width > _SPARE + justified * len(values):
            raise SatvibError(f'damaged: a list of {width} in messages with {given} in all')
        result = np.full((count, len(values), width), np.nan)
        for strut, column in enumerate(values):
            for row, item in zip(rows[strut], column, strict=True):
                result[row, strut, : len(item)] = item
        return result
    elif isinstance(sample, float):
        result = np.full((count, len(values)), np.nan)
    else:
        result = np.zeros(
            (count, len(values)), dtype=bool if isinstance(sample, bool) else np.int64
        )
    for strut, column in enumerate(values):
        if column:
            result[rows[strut], strut] = column
    return result
