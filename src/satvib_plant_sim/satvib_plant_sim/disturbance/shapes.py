# SPDX-FileCopyrightText: 2026 The satvib authors
# SPDX-License-Identifier: Apache-2.0
"""Aperiodic shapes: a half-sine pulse, a trapezoid and a decaying burst, once or repeated every `period`.

pulse:     a sin(pi t / D),  0 <= t < D
trapezoid: a up in `rise`, for `hold`, back in `fall`, all straight lines
burst:     a exp(-t / tau) sin(2 pi f t)
"""

import math
from dataclasses import dataclass
from enum import IntEnum
from typing import ClassVar, NamedTuple

from satvib_common.errors import SatvibError
from satvib_common.kernels.compile import Kernel, kernel
from satvib_common.kernels.deferred import njit
from satvib_common.schema import param

from satvib_plant_sim.disturbance.base import Disturbance, Transfer
from satvib_plant_sim.disturbance.window import acts, elapsed


class ShapeKind(IntEnum):
    """Which shape."""

    PULSE = 0
    TRAPEZOID = 1
    BURST = 2


class ShapeValues(NamedTuple):
    """Numbers of a shape: repetition in s (0: once), `ShapeKind`, height in m/s^2 (N), then its own numbers.

    Attributes:
        a, b, c: pulse: duration; trapezoid: rise, hold, fall; burst: time constant; s. Burst, b: frequency, Hz.
    """

    repetition: float
    kind: float
    height: float
    a: float
    b: float = 0.0
    c: float = 0.0


@njit
def _pulse(s, t):
    return s.height * math.sin(math.pi * t / s.a) if t < s.a else 0.0


@njit
def _trapezoid(s, t):
    if t < s.a:
        return s.height * t / s.a
    if t < s.a + s.b:
        return s.height
    if t < s.a + s.b + s.c:
        return s.height * (s.a + s.b + s.c - t) / s.c
    return 0.0


@njit
def _burst(s, t):
    return s.height * math.exp(-t / s.a) * math.sin(2.0 * math.pi * s.b * t)


@kernel('void(f8[:],f8[:],f8,f8[:],f8[:])', '(w),(p),(),(f)->(f)')
def shape_values(window, p, first, grid, out):
    """Give a shape; p is `ShapeValues`."""
    s = ShapeValues(p[0], p[1], p[2], p[3], p[4], p[5])
    kind = int(s.kind)
    for j in range(grid.shape[0]):
        n = first + grid[j]
        out[j] = 0.0
        if acts(window, n):
            t = elapsed(window, n)
            if s.repetition > 0.0:
                t -= s.repetition * math.floor(t / s.repetition + 1e-9)
            if kind == ShapeKind.PULSE:
                out[j] = _pulse(s, t)
            elif kind == ShapeKind.TRAPEZOID:
                out[j] = _trapezoid(s, t)
            else:
                out[j] = _burst(s, t)


@dataclass(frozen=True, kw_only=True)
class Shape(Disturbance):
    """What the shapes share."""

    amplitude: float = param(description='height, of the source', unit='m/s^2 (N)')
    period: float | None = param(None, 'repeats after; none: once', unit='s', above=0.0)

    KERNEL: ClassVar[Kernel] = shape_values

    def length(self) -> float:
        """Give the time a shape takes, s."""
        return 0.0

    def check(self) -> None:
        """Refuse a repetition before the end."""
        super().check()
        if self.period is not None and self.period < self.length():
            raise SatvibError(
                f'period: {self.period} s is shorter than the shape, {self.length()} s'
            )


@dataclass(frozen=True, kw_only=True)
class Pulse(Shape):
    """A half-sine."""

    kind: str = param('pulse', 'kind', choices=('pulse',))
    duration: float = param(description='length of the half-sine', unit='s', above=0.0)

    def length(self) -> float:
        """Give the duration, s."""
        return self.duration

    def highest(self) -> tuple[str, float]:
        """Give the frequency of which the pulse is half a period."""
        return 'duration', 0.5 / self.duration

    def values(self, transfer: Transfer) -> ShapeValues:  # noqa: ARG002 - no fixed frequency
        """The numbers of the pulse."""
        return ShapeValues(self.period or 0.0, ShapeKind.PULSE, self.amplitude, a=self.duration)


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

    def highest(self) -> tuple[str, float]:
        """Give the frequency of which the whole is half a period; a flank may be as steep as a step."""
        return 'hold', 0.5 / self.length()

    def values(self, transfer: Transfer) -> ShapeValues:  # noqa: ARG002 - no fixed frequency
        """The numbers of the trapezoid."""
        times = {'a': self.rise, 'b': self.hold, 'c': self.fall}
        return ShapeValues(self.period or 0.0, ShapeKind.TRAPEZOID, self.amplitude, **times)


@dataclass(frozen=True, kw_only=True)
class Burst(Shape):
    """A decaying oscillation."""

    kind: str = param('burst', 'kind', choices=('burst',))
    frequency: float = param(description='of the oscillation', unit='Hz', above=0.0)
    decay: float = param(description='time constant of the decay', unit='s', above=0.0)

    def highest(self) -> tuple[str, float]:
        """Give the frequency of the oscillation, or the corner of the decay where that is higher."""
        edges = {'frequency': self.frequency, 'decay': 0.5 / (math.pi * self.decay)}
        return max(edges.items(), key=lambda edge: edge[1])

    def values(self, transfer: Transfer) -> ShapeValues:  # noqa: ARG002 - no fixed frequency
        """The numbers of the burst."""
        repetition = self.period or 0.0
        return ShapeValues(
            repetition, ShapeKind.BURST, self.amplitude, a=self.decay, b=self.frequency
        )
