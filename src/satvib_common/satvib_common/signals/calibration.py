# SPDX-FileCopyrightText: 2026 The satvib authors
# SPDX-License-Identifier: Apache-2.0
"""Bias calibration: what a sensor reads at rest (the paper: "compensated by initial bias error")."""

import numpy as np

from satvib_common.arrays import Array


class BiasCalibration:
    """Running mean and deviation of a channel at rest.

    Welford's recursion, so that neither a long calibration nor a large offset loses digits.

    Args:
        shape: leading axes.
    """

    def __init__(self, shape: tuple[int, ...] = ()) -> None:
        self.count = np.zeros(shape)
        self.mean = np.zeros(shape)
        self._squares = np.zeros(shape)

    def add(self, value: Array) -> None:
        """Take one sample (shape); a value that is not finite is left out."""
        good = np.isfinite(value)
        value = np.where(good, value, 0.0)
        self.count = self.count + good
        delta = value - self.mean
        self.mean = np.where(good, self.mean + delta / np.maximum(self.count, 1.0), self.mean)
        self._squares = np.where(good, self._squares + delta * (value - self.mean), self._squares)

    @property
    def standard_deviation(self) -> Array:
        """Sample standard deviation (shape); NaN before the second sample."""
        with np.errstate(invalid='ignore', divide='ignore'):
            variance = self._squares / (self.count - 1.0)
        return np.sqrt(np.where(self.count > 1.0, variance, np.nan))

    def reset(self) -> None:
        """Start again."""
        self.count = np.zeros_like(self.count)
        self.mean = np.zeros_like(self.mean)
        self._squares = np.zeros_like(self._squares)
