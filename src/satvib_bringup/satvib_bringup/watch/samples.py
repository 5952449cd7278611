# SPDX-FileCopyrightText: 2026 The satvib authors
# SPDX-License-Identifier: Apache-2.0
"""The newest samples of a strut, by their sequence: put in as they come, read as blocks with their extremes."""

from enum import IntEnum

import numpy as np
from satvib_common.arrays import Array, Integers


class Column(IntEnum):
    """What is kept of a sample."""

    UPPER = 0
    LOWER = 1
    ASKED = 2
    APPLIED = 3


class SampleRing:
    """The newest samples of one strut; NaN where one is not known.

    Args:
        capacity: samples that are kept.

    Attributes:
        head: sequence of the newest sample; -1 before the first.
        changed: the oldest sequence that was put in since somebody has set this to `head` + 1.
    """

    def __init__(self, capacity: int) -> None:
        self.capacity = capacity
        self.head = -1
        self.changed = 0
        self._values: Array = np.full((len(Column), capacity), np.nan)

    def put(self, columns: slice, sequences: Integers, values: Array) -> None:
        """Put samples in; those that are older than what is kept are left out.

        Args:
            columns: which of `Column`.
            sequences: (samples,).
            values: (samples, columns).
        """
        if not len(sequences):
            return
        newest = int(sequences.max())
        self.changed = min(self.changed, int(sequences.min()))
        if newest > self.head:
            first = max(self.head + 1, newest + 1 - self.capacity)
            self._values[:, np.arange(first, newest + 1) % self.capacity] = np.nan
            self.head = newest
        kept = sequences > self.head - self.capacity
        self._values[columns, sequences[kept] % self.capacity] = values[kept].T

    def newest(self, column: Column, count: int) -> Array:
        """The newest samples of a column in their order, at most `count` and at most what is kept."""
        count = min(count, self.capacity, self.head + 1)
        rows = np.arange(self.head + 1 - count, self.head + 1) % self.capacity
        found: Array = self._values[column, rows]
        return found

    def blocks(self, first: int, last: int, size: int) -> tuple[Array, Array]:
        """Least and largest value of each block of samples.

        Args:
            first, last: blocks [first, last); block b has the samples from b size on.
            size: samples in a block.

        Returns:
            two arrays (columns, blocks); NaN where no sample is known, or none is kept.
        """
        rows = np.arange(first * size, last * size)
        values = self._values[:, rows % self.capacity]
        values[:, (rows > self.head) | (rows <= self.head - self.capacity)] = np.nan
        shaped = values.reshape(len(Column), last - first, size)
        return np.fmin.reduce(shaped, axis=2), np.fmax.reduce(shaped, axis=2)
