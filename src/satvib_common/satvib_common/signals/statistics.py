# SPDX-FileCopyrightText: 2026 The satvib authors
# SPDX-License-Identifier: Apache-2.0
"""Running RMS."""

import numpy as np

from satvib_common.arrays import Array


class MovingRms:
    """Root mean square over the last `window` samples (fewer at the start).

    Args:
        window: samples.
        shape: leading axes.
    """

    def __init__(self, window: int, shape: tuple[int, ...] = ()) -> None:
        self._squares = np.zeros((window, *shape))
        self._sum = np.zeros(shape)
        self._next = 0
        self._count = 0

    def add(self, value: Array) -> Array:
        """Take one sample (shape) and give the RMS so far (shape). A value that is not finite counts as 0."""
        square = np.where(np.isfinite(value), value * value, 0.0)
        window = len(self._squares)
        self._sum = self._sum - self._squares[self._next] + square
        self._squares[self._next] = square
        self._next = (self._next + 1) % window
        self._count = min(self._count + 1, window)
        if self._next == 0:  # once a window, add up again without the rounding errors
            self._sum = np.zeros_like(self._sum)
            for row in self._squares:
                self._sum = self._sum + row
        return np.sqrt(np.maximum(self._sum, 0.0) / self._count)
