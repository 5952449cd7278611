# SPDX-FileCopyrightText: 2026 The satvib authors
# SPDX-License-Identifier: Apache-2.0
"""A reaction wheel: harmonics whose amplitude grows with the square of the speed.

    d(t) = sum_i C_i Omega^2 sin(h_i theta(t) + phase_i),   Omega = theta',

the usual empirical model of wheel disturbances (Masterson, Miller and Grogan 2002, J. Sound and Vibration 249, 575).
The speed is constant, or goes in a straight line from `speed` to `end_speed` between `ramp_start` and `ramp_start` +
`ramp_time` after the start: theta is the exact integral. At constant speed each harmonic is corrected to the lower
plate's acceleration; a ramp is not.

A *mounted* wheel has an axis and a place. Its radial force and its radial torque turn with the wheel: each has two
parts at right angles, a quarter of a turn apart. Its axial force is one part. A force at p from the centre of gravity
is a moment p x F as well.
"""

import math
from collections.abc import Sequence
from dataclasses import dataclass
from typing import ClassVar, NamedTuple

from satvib_common.errors import SatvibError
from satvib_common.kernels.compile import Kernel, kernel
from satvib_common.schema import param

from satvib_plant_sim.disturbance.base import Disturbance, Transfer
from satvib_plant_sim.disturbance.window import acts, elapsed
from satvib_plant_sim.rig.structure import FARTHEST


class WheelSpeed(NamedTuple):
    """Speed at the start and after the ramp, rad/s; when the ramp begins and how long it lasts, s."""

    begin: float
    end: float
    ramp_start: float
    ramp_time: float


class Harmonic(NamedTuple):
    """C in m/s^2 (N) per (rad/s)^2, h, and the phase in rad."""

    coefficient: float
    multiple: float
    phase: float


@kernel('void(f8[:],f8[:],f8,f8[:],f8[:])', '(w),(p),(),(f)->(f)')
def wheel_values(window, p, first, grid, out):
    """Add up the harmonics of a wheel; p holds `WheelSpeed`, then one `Harmonic` after the other."""
    w = WheelSpeed(p[0], p[1], p[2], p[3])
    for j in range(grid.shape[0]):
        n = first + grid[j]
        total = 0.0
        if acts(window, n):
            t = elapsed(window, n)
            since = min(max(t - w.ramp_start, 0.0), w.ramp_time)
            share = since / w.ramp_time if w.ramp_time > 0.0 else 0.0
            change = w.end - w.begin
            speed = w.begin + change * share
            after = max(t - w.ramp_start - w.ramp_time, 0.0)
            theta = w.begin * t + change * (0.5 * since * share + after)
            for i in range(4, p.shape[0], 3):
                harmonic = Harmonic(p[i], p[i + 1], p[i + 2])
                angle = harmonic.multiple * theta + harmonic.phase
                total += harmonic.coefficient * speed * speed * math.sin(angle)
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

    def highest(self) -> tuple[str, float]:
        """Give the highest harmonic at the higher speed."""
        return 'harmonics', max(self.harmonics, default=0.0) * max(
            self.speed, self.end_speed or 0.0
        )

    def values(self, transfer: Transfer) -> list[float]:
        """The numbers of the speed, then those of each harmonic."""
        end = self.speed if self.end_speed is None else self.end_speed
        turn = 2.0 * math.pi
        speed = WheelSpeed(
            begin=turn * self.speed,
            end=turn * end,
            ramp_start=self.ramp_start,
            ramp_time=self.ramp_time,
        )
        found = list(speed)
        steady = self.tones()
        phases = self.phases or (0.0,) * len(self.harmonics)
        for i, (c, h, p) in enumerate(zip(self.coefficients, self.harmonics, phases, strict=True)):
            coefficient = c / transfer(steady[i]) if steady else c
            found += Harmonic(coefficient=coefficient, multiple=h, phase=math.radians(p))
        return found


@dataclass(frozen=True, kw_only=True)
class MountedWheel(Disturbance):
    """A wheel with an axis: radial force and torque that turn, and an axial force.

    On the base the coefficients are of the base's acceleration (m/s^2 and rad/s^2 per (rad/s)^2), and it has no place.
    """

    kind: str = param('mounted_wheel', 'kind', choices=('mounted_wheel',))
    speed: float = param(description='at start, turns per second', unit='Hz', minimum=0.0)
    end_speed: float | None = param(None, 'after the ramp; none: no ramp', unit='Hz', minimum=0.0)
    ramp_start: float = param(0.0, 'when the ramp begins, after start', unit='s', minimum=0.0)
    ramp_time: float = param(10.0, 'how long the ramp lasts', unit='s', above=0.0)
    axis: tuple[float, ...] = param((0.0, 0.0, 1.0), 'x, y, z, of any length')
    position: tuple[float, ...] = param(
        (0.0, 0.0, 0.0), 'x, y, z from the centre of gravity of the payload',
        unit='m', minimum=-FARTHEST, maximum=FARTHEST,
    )  # fmt: skip
    harmonics: tuple[float, ...] = param((1.0,), 'multiples of the speed', above=0.0)
    phases: tuple[float, ...] = param((), 'of each harmonic at start; none: all 0', unit='deg')
    radial: tuple[float, ...] = param((), 'C of the radial force; none: 0', unit='N per (rad/s)^2')
    axial: tuple[float, ...] = param((), 'C of the axial force; none: 0', unit='N per (rad/s)^2')
    torque: tuple[float, ...] = param(
        (), 'C of the radial torque; none: 0', unit='N m per (rad/s)^2'
    )

    def check(self) -> None:
        """Refuse a wheel without an axis, and lists of different lengths."""
        super().check()
        if self.direction:
            raise SatvibError('direction: a mounted wheel has an axis')
        for name in ('axis', 'position'):
            if len(getattr(self, name)) != 3:
                raise SatvibError(f'{name}: x, y and z are expected')
        if not math.hypot(*self.axis) > 0.0:
            raise SatvibError('axis: gives no direction')
        if self.target == 'base' and any(self.position):
            raise SatvibError('position: a wheel on the base has none')
        for name in ('phases', 'radial', 'axial', 'torque'):
            if len(getattr(self, name)) not in {0, len(self.harmonics)}:
                raise SatvibError(
                    f'{name}: {len(getattr(self, name))} for {len(self.harmonics)} harmonics'
                )

    def parts(self) -> tuple[Disturbance, ...]:
        """Give the force and torque components, each a `ReactionWheel` along its own direction."""
        axis = [a / math.hypot(*self.axis) for a in self.axis]
        # from the coordinate axis that is most across
        most = min(range(3), key=lambda i: abs(axis[i]))
        across = _cross(axis, [float(i == most) for i in range(3)])
        first = [a / math.hypot(*across) for a in across]
        second = _cross(axis, first)
        none = [0.0, 0.0, 0.0]
        found = []
        for coefficients, along, quarter in (
            (self.radial, first, 0.0), (self.radial, second, -90.0), (self.axial, axis, 0.0),
        ):  # fmt: skip
            moment = _cross(self.position, along)
            found.append((coefficients, [*along, *moment], quarter))
        found += [(self.torque, [*none, *first], 0.0), (self.torque, [*none, *second], -90.0)]
        phases = self.phases or (0.0,) * len(self.harmonics)
        return tuple(
            ReactionWheel(
                start=self.start, stop=self.stop, target=self.target, direction=tuple(direction),
                speed=self.speed, end_speed=self.end_speed, ramp_start=self.ramp_start,
                ramp_time=self.ramp_time, harmonics=self.harmonics, coefficients=coefficients,
                phases=tuple(phase + quarter for phase in phases),
            )
            for coefficients, direction, quarter in found
            if any(coefficients)
        )  # fmt: skip

    def tones(self) -> tuple[float, ...]:
        """Give the harmonics' frequencies at constant speed; empty with a ramp."""
        return tuple(sorted({f for part in self.parts() for f in part.tones()}))


def _cross(a: Sequence[float], b: Sequence[float]) -> list[float]:
    return [
        a[1] * b[2] - a[2] * b[1] + 0.0,
        a[2] * b[0] - a[0] * b[2] + 0.0,
        a[0] * b[1] - a[1] * b[0] + 0.0,
    ]
