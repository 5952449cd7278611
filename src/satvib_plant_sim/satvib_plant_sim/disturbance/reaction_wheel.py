# SPDX-FileCopyrightText: 2026 The satvib authors
# SPDX-License-Identifier: Apache-2.0
"""A reaction wheel: harmonics whose amplitude grows with the square of the speed.

    d(t) = sum_i C_i Omega^2 sin(h_i theta(t) + phase_i),   Omega = theta',

the usual empirical model of wheel disturbances (Masterson, Miller and Grogan 2002, J. Sound and Vibration 249, 575).
The speed is constant, or goes in a straight line from `speed` to `end_speed` between `ramp_start` and `ramp_start` +
`ramp_time` after the start: theta is the exact integral. At constant speed each harmonic is corrected to the lower
plate's acceleration; a ramp is not.
"""

import math
from dataclasses import dataclass
from typing import ClassVar

from satvib_common.errors import SatvibError
from satvib_common.kernels.compile import Kernel, kernel
from satvib_common.schema import param

from satvib_plant_sim.disturbance.base import Disturbance, Transfer


@kernel('void(f8[:],f8,f8[:],f8[:])', '(p),(),(f)->(f)')
def wheel_values(p, first, grid, out):
    """p: start, stop, period, W_0, W_1 (rad/s), ramp start, ramp time; then C, h, phase of each harmonic."""
    for j in range(grid.shape[0]):
        n = first + grid[j]
        total = 0.0
        if p[0] <= n < p[1]:
            t = (n - p[0]) * p[2]
            since = min(max(t - p[5], 0.0), p[6])
            share = since / p[6] if p[6] > 0.0 else 0.0
            speed = p[3] + (p[4] - p[3]) * share
            theta = p[3] * t + (p[4] - p[3]) * (0.5 * since * share + max(t - p[5] - p[6], 0.0))
            for i in range(7, p.shape[0], 3):
                total += p[i] * speed * speed * math.sin(p[i + 1] * theta + p[i + 2])
        out[j] = total


@dataclass(frozen=True, kw_only=True)
class ReactionWheel(Disturbance):
    """Harmonics of a wheel's speed."""

    kind: str = param('reaction_wheel', 'kind', choices=('reaction_wheel',))
    speed: float = param(description='at start, turns per second', unit='Hz', minimum=0.0)
    end_speed: float | None = param(None, 'after the ramp; none: no ramp', unit='Hz', minimum=0.0)
    ramp_start: float = param(0.0, 'when the ramp begins, after start', unit='s', minimum=0.0)
    ramp_time: float = param(10.0, 'how long the ramp lasts', unit='s', above=0.0)
    harmonics: tuple[float, ...] = param((1.0,), 'multiples of the speed', above=0.0)
    coefficients: tuple[float, ...] = param(
        description='C of each harmonic', unit='m/s^2 (N) per (rad/s)^2'
    )
    phases: tuple[float, ...] = param((), 'of each harmonic at start; none: all 0', unit='deg')

    KERNEL: ClassVar[Kernel] = wheel_values

    def check(self) -> None:
        """Refuse lists of different lengths."""
        super().check()
        count = len(self.harmonics)
        if len(self.coefficients) != count:
            raise SatvibError(f'coefficients: {len(self.coefficients)} for {count} harmonics')
        if len(self.phases) not in {0, count}:
            raise SatvibError(f'phases: {len(self.phases)} for {count} harmonics')

    def tones(self) -> tuple[float, ...]:
        """Give the harmonics' frequencies at constant speed; empty with a ramp."""
        if self.end_speed not in {None, self.speed} or self.speed == 0.0:
            return ()
        return tuple(h * self.speed for h in self.harmonics)

    def values(self, transfer: Transfer) -> list[float]:
        """Speeds and ramp, then C, h, phase of each harmonic."""
        end = self.speed if self.end_speed is None else self.end_speed
        turn = 2.0 * math.pi
        found = [turn * self.speed, turn * end, self.ramp_start, self.ramp_time]
        steady = self.tones()
        phases = self.phases or (0.0,) * len(self.harmonics)
        for i, (c, h, p) in enumerate(zip(self.coefficients, self.harmonics, phases, strict=True)):
            found += [c / transfer(steady[i]) if steady else c, h, math.radians(p)]
        return found
