# SPDX-FileCopyrightText: 2026 The satvib authors
# SPDX-License-Identifier: Apache-2.0
"""Running RMS."""

import numpy as np

from satvib_common.arrays import Array
from satvib_common.kernels.compile import kernel


@kernel('void(f8, f8, f8, f8, f8[:], f8[:], f8[:])', '(),(),(),()->(),(),()')
def rms_step(value, oldest, total, count, square, sum_, rms):
    """Exchange the oldest square in a sum of `count` of them for that of a value; gives square, sum and RMS."""
    square[0] = value * value if abs(value) < np.inf else 0.0
    sum_[0] = total - oldest + square[0]
    rms[0] = np.sqrt(max(sum_[0], 0.0) / count)


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
        window = len(self._squares)
        self._count = min(self._count + 1, window)
        square, self._sum, rms = rms_step(value, self._squares[self._next], self._sum, self._count)
        self._squares[self._next] = square
        self._next = (self._next + 1) % window
        if self._next == 0:  # once a window, add up again without the rounding errors
            self._sum = np.zeros_like(self._sum)
            for row in self._squares:
                self._sum = self._sum + row
            rms = np.sqrt(np.maximum(self._sum, 0.0) / self._count)
        return np.asarray(rms)
