# SPDX-FileCopyrightText: 2026 The satvib authors
# SPDX-License-Identifier: Apache-2.0
"""A tone that moves: a sin(phi(t)) from f_0 to f_1 in D seconds, then at f_1.

Linear: phi = 2 pi (f_0 t + (f_1 - f_0) t^2 / (2 D)). Logarithmic: phi = 2 pi f_0 D / ln r (r^(t/D) - 1), r = f_1 / f_0.
The phase goes on without a jump when the sweep ends.
"""

import math
from dataclasses import dataclass
from typing import ClassVar

from satvib_common.errors import SatvibError
from satvib_common.kernels.compile import Kernel, kernel
from satvib_common.schema import param

from satvib_plant_sim.disturbance.base import Disturbance, Transfer


@kernel('void(f8[:],f8,f8[:],f8[:])', '(p),(),(f)->(f)')
def sweep_values(p, first, grid, out):
    """p: start, stop, period, amplitude, f_0, f_1, D, ln r (0: linear)."""
    for j in range(grid.shape[0]):
        n = first + grid[j]
        out[j] = 0.0
        if p[0] <= n < p[1]:
            t = (n - p[0]) * p[2]
            swept = min(t, p[6])
            if p[7] == 0.0:
                turns = p[4] * swept + 0.5 * (p[5] - p[4]) * swept * swept / p[6]
            else:
                turns = p[4] * p[6] / p[7] * (math.exp(p[7] * swept / p[6]) - 1.0)
            turns += p[5] * (t - swept)
            out[j] = p[3] * math.sin(2.0 * math.pi * turns)


@dataclass(frozen=True, kw_only=True)
class Sweep(Disturbance):
    """A tone that moves from one frequency to another."""

    kind: str = param('sweep', 'kind', choices=('sweep',))
    amplitude: float = param(description='of the source', unit='m/s^2 (N)')
    frequency: float = param(description='at start', unit='Hz', above=0.0)
    end_frequency: float = param(description='at the end of the sweep', unit='Hz', above=0.0)
    duration: float = param(description='of the sweep', unit='s', above=0.0)
    shape: str = param('linear', 'frequency over time', choices=('linear', 'log'))

    KERNEL: ClassVar[Kernel] = sweep_values

    def check(self) -> None:
        """Refuse a logarithmic sweep that goes nowhere."""
        super().check()
        if self.shape == 'log' and self.frequency == self.end_frequency:
            raise SatvibError('end_frequency: a log sweep needs another one than frequency')

    def values(self, transfer: Transfer) -> list[float]:  # noqa: ARG002 - no fixed frequency
        """Amplitude, f_0, f_1, D, ln r."""
        log = math.log(self.end_frequency / self.frequency) if self.shape == 'log' else 0.0
        return [self.amplitude, self.frequency, self.end_frequency, self.duration, log]
