# SPDX-FileCopyrightText: 2026 The satvib authors
# SPDX-License-Identifier: Apache-2.0
"""Periodic signals made of lines in a band, kept as one period in a table."""

from dataclasses import dataclass
from functools import cached_property

import numpy as np
from satvib_common.arrays import Array, Integers
from satvib_common.errors import SatvibError
from satvib_common.schema import param

from satvib_ident.excitation.signal import Excitation


@dataclass(frozen=True, kw_only=True)
class PeriodicExcitation(Excitation):
    """Lines at multiples of 1 / period between low and high."""

    low: float = param(1.0, 'lowest frequency', unit='Hz', above=0.0)
    high: float = param(25.0, 'highest frequency', unit='Hz', above=0.0)
    period: float = param(2.0, 'length of a period', unit='s', above=0.0)

    @property
    def count(self) -> int:
        """Samples in a period."""
        return max(round(self.period / self.dt), 2)

    @property
    def lines(self) -> Integers:
        """The multiples of 1 / period in the band."""
        step = 1.0 / (self.count * self.dt)
        first = int(np.ceil(self.low / step * (1.0 - 1e-9)))
        last = int(np.floor(self.high / step * (1.0 + 1e-9)))
        return np.arange(max(first, 1), last + 1)

    def check(self) -> None:
        """Refuse a band that is empty or that the sample rate cannot carry."""
        if self.high * self.dt >= 0.5:
            raise SatvibError(
                f'high: {self.high} Hz is not below half the sample rate, {0.5 / self.dt:g} Hz'
            )
        if self.lines.size == 0:
            raise SatvibError(
                f'low, high, period: no multiple of {1.0 / self.period:g} Hz lies between '
                f'{self.low} and {self.high} Hz'
            )

    def table(self) -> Array:
        """Make one period with any peak, (count)."""
        raise NotImplementedError

    @cached_property
    def values(self) -> Array:
        """One period with the wanted peak, V, (count)."""
        shape = self.table()
        return shape * (self.amplitude / float(np.max(np.abs(shape))))

    def at(self, i: int) -> float:
        """Voltage in V at sample i."""
        return float(self.values[i % self.count])
