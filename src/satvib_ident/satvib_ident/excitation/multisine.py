# SPDX-FileCopyrightText: 2026 The satvib authors
# SPDX-License-Identifier: Apache-2.0
"""Multisine: equal lines in a band, with phases that make the peak small.

    u(t) = sum_l cos(2 pi l t / period + phi_l)

The phases are those of `satvib_common.signals.crest`.

With several struts each takes every n-th line, so that over a period no strut's signal correlates with another's at
any lag.
"""

from dataclasses import dataclass

import numpy as np
from satvib_common.arrays import Array, Integers
from satvib_common.errors import SatvibError
from satvib_common.schema import param
from satvib_common.signals.crest import FINER, low_crest_phases

from satvib_ident.excitation.periodic import PeriodicExcitation


@dataclass(frozen=True, kw_only=True)
class Multisine(PeriodicExcitation):
    """Equal lines with optimized phases."""

    interleave: bool = param(True, 'each strut takes lines of its own')

    @property
    def own_lines(self) -> Integers:
        """The lines of this strut."""
        if self.interleave:
            return self.lines[self.strut % self.struts :: self.struts]
        return self.lines

    def check(self) -> None:
        """Refuse a band with fewer lines than struts."""
        super().check()
        if self.interleave and self.lines.size < self.struts:
            raise SatvibError(
                f'low, high, period: {self.lines.size} lines are too few for {self.struts} struts'
            )

    def table(self) -> Array:
        """One period."""
        lines = self.own_lines
        fine = FINER * self.count
        generator = np.random.default_rng([self.seed, self.strut])
        spectrum = np.zeros(fine // 2 + 1, dtype=complex)
        spectrum[lines] = np.exp(1j * low_crest_phases(lines, self.count, generator))
        return np.asarray(np.fft.irfft(spectrum, fine)[::FINER])
