# SPDX-FileCopyrightText: 2026 The satvib authors
# SPDX-License-Identifier: Apache-2.0
"""Aperiodic shapes: a half-sine pulse, a trapezoid and a decaying burst, once or repeated every `period`.

pulse:     a sin(pi t / D),  0 <= t < D
trapezoid: a up in `rise`, for `hold`, back in `fall`, all straight lines
burst:     a exp(-t / tau) sin(2 pi f t)
"""

import math
from dataclasses import dataclass
from typing import ClassVar

from satvib_common.errors import SatvibError
from satvib_common.kernels.compile import Kernel, kernel
from satvib_common.schema import param

from satvib_plant_sim.disturbance.base import Disturbance, Transfer

PULSE, TRAPEZOID, BURST = 0.0, 1.0, 2.0


@kernel('void(f8[:],f8,f8[:],f8[:])', '(p),(),(f)->(f)')
def shape_values(p, first, grid, out):
    """p: start, stop, period; repetition in s (0: once), which shape, amplitude, then three numbers."""
    for j in range(grid.shape[0]):
        n = first + grid[j]
        out[j] = 0.0
        if p[0] <= n < p[1]:
            t = (n - p[0]) * p[2]
            if p[3] > 0.0:
                t -= p[3] * math.floor(t / p[3] + 1e-9)
            if p[4] == PULSE:
                if t < p[6]:
                    out[j] = p[5] * math.sin(math.pi * t / p[6])
            elif p[4] == TRAPEZOID:
                if t < p[6]:
                    out[j] = p[5] * t / p[6]
                elif t < p[6] + p[7]:
                    out[j] = p[5]
                elif t < p[6] + p[7] + p[8]:
                    out[j] = p[5] * (p[6] + p[7] + p[8] - t) / p[8]
            else:
                out[j] = p[5] * math.exp(-t / p[6]) * math.sin(2.0 * math.pi * p[7] * t)


@dataclass(frozen=True, kw_only=True)
class Shape(Disturbance):
    """What the shapes share."""

    amplitude: float = param(description='height, of the source', unit='m/s^2 (N)')
    period: float | None = param(None, 'repeats after; none: once', unit='s', above=0.0)

    KERNEL: ClassVar[Kernel] = shape_values

    def length(self) -> float:
        """Give the time a shape takes, s."""
        return 0.0

    def numbers(self) -> list[float]:
        """Give which shape, its amplitude and its own numbers."""
        raise NotImplementedError

    def check(self) -> None:
        """Refuse a repetition before the end."""
        super().check()
        if self.period is not None and self.period < self.length():
            raise SatvibError(
                f'period: {self.period} s is shorter than the shape, {self.length()} s'
            )

    def values(self, transfer: Transfer) -> list[float]:  # noqa: ARG002 - no fixed frequency
        """Repetition in s, then `numbers`."""
        return [self.period or 0.0, *self.numbers()]


@dataclass(frozen=True, kw_only=True)
class Pulse(Shape):
    """A half-sine."""

    kind: str = param('pulse', 'kind', choices=('pulse',))
    duration: float = param(description='length of the half-sine', unit='s', above=0.0)

    def length(self) -> float:
        """Give the duration, s."""
        return self.duration

    def numbers(self) -> list[float]:
        """Shape, amplitude, duration."""
        return [PULSE, self.amplitude, self.duration, 0.0, 0.0]


@dataclass(frozen=True, kw_only=True)
class Trapezoid(Shape):
    """Up, stay, down."""

    kind: str = param('trapezoid', 'kind', choices=('trapezoid',))
    rise: float = param(description='time up', unit='s', above=0.0)
    hold: float = param(description='time at the top', unit='s', minimum=0.0)
    fall: float = param(description='time down', unit='s', above=0.0)

    def length(self) -> float:
        """Give the whole time, s."""
        return self.rise + self.hold + self.fall

    def numbers(self) -> list[float]:
        """Shape, amplitude, rise, hold, fall."""
        return [TRAPEZOID, self.amplitude, self.rise, self.hold, self.fall]


@dataclass(frozen=True, kw_only=True)
class Burst(Shape):
    """A decaying oscillation."""

    kind: str = param('burst', 'kind', choices=('burst',))
    frequency: float = param(description='of the oscillation', unit='Hz', above=0.0)
    decay: float = param(description='time constant of the decay', unit='s', above=0.0)

    def numbers(self) -> list[float]:
        """Shape, amplitude, time constant, frequency."""
        return [BURST, self.amplitude, self.decay, self.frequency, 0.0]
