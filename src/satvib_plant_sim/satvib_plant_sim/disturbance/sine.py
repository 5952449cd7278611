# SPDX-FileCopyrightText: 2026 The satvib authors
# SPDX-License-Identifier: Apache-2.0
"""One tone: a sin(2 pi f t + phase)."""

import math
from dataclasses import dataclass
from typing import ClassVar

from satvib_common.kernels.compile import Kernel, kernel
from satvib_common.schema import param

from satvib_plant_sim.disturbance.base import Disturbance, Transfer


@kernel('void(f8[:],f8,f8[:],f8[:])', '(p),(),(f)->(f)')
def sine_values(p, first, grid, out):
    """p: start, stop, period, then amplitude, rad/s and rad of each tone."""
    for j in range(grid.shape[0]):
        n = first + grid[j]
        total = 0.0
        if p[0] <= n < p[1]:
            t = (n - p[0]) * p[2]
            for i in range(3, p.shape[0], 3):
                total += p[i] * math.sin(p[i + 1] * t + p[i + 2])
        out[j] = total


@dataclass(frozen=True, kw_only=True)
class Sine(Disturbance):
    """One tone."""

    kind: str = param('sine', 'kind', choices=('sine',))
    amplitude: float = param(description='lower plate with control off', unit='m/s^2 (N)')
    frequency: float = param(description='frequency', unit='Hz', above=0.0)
    phase: float = param(0.0, 'phase at start', unit='deg')

    KERNEL: ClassVar[Kernel] = sine_values

    def tones(self) -> tuple[float, ...]:
        """Give the frequency."""
        return (self.frequency,)

    def values(self, transfer: Transfer) -> list[float]:
        """Amplitude, rad/s, rad."""
        return [
            self.amplitude / transfer(self.frequency),
            2.0 * math.pi * self.frequency,
            math.radians(self.phase),
        ]
