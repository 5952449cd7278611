# SPDX-FileCopyrightText: 2026 The satvib authors
# SPDX-License-Identifier: Apache-2.0
"""One tone: a sin(2 pi f t + phase)."""

import math
from dataclasses import dataclass
from typing import ClassVar, NamedTuple

from satvib_common.kernels.compile import Kernel, kernel
from satvib_common.schema import param

from satvib_plant_sim.disturbance.base import Disturbance, Transfer
from satvib_plant_sim.disturbance.window import acts, elapsed


class Tone(NamedTuple):
    """One tone: amplitude in m/s^2 (N), angular frequency in rad/s, phase in rad."""

    amplitude: float
    speed: float
    phase: float


@kernel('void(f8[:],f8[:],f8,f8[:],f8[:])', '(w),(p),(),(f)->(f)')
def sine_values(window, p, first, grid, out):
    """Add up tones; p holds one `Tone` after the other."""
    for j in range(grid.shape[0]):
        n = first + grid[j]
        total = 0.0
        if acts(window, n):
            t = elapsed(window, n)
            for i in range(0, p.shape[0], 3):
                tone = Tone(p[i], p[i + 1], p[i + 2])
                total += tone.amplitude * math.sin(tone.speed * t + tone.phase)
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

    def lines(self, transfer: Transfer) -> list[Tone]:
        """Give the one tone."""
        return [
            Tone(
                amplitude=self.amplitude / transfer(self.frequency),
                speed=2.0 * math.pi * self.frequency,
                phase=math.radians(self.phase),
            )
        ]

    def values(self, transfer: Transfer) -> list[float]:
        """The numbers of the tone."""
        return [number for tone in self.lines(transfer) for number in tone]
