# SPDX-FileCopyrightText: 2026 The satvib authors
# SPDX-License-Identifier: Apache-2.0
"""What every kind of disturbance shares.

A disturbance is a function of the fine index alone: with h the fine period, t = (n - n_start) h and n_start the fine
point nearest to `start`. So any sample can be asked for in any order and gives the same bits. It acts on the base
(acceleration of the shaker's source, m/s^2) or as a force on the payload (N), along z, or as `direction` says: the
base moves by `direction` times the disturbance along x, y, z and about them (rad/s^2), the payload gets such forces
and moments (N m).

The amplitude of a kind with fixed frequencies is the *lower plate's* acceleration with control off: each tone is
divided by |T(jw)|, T from the source to the lower plate of the rig at 0 V. Kinds without fixed frequencies are not
corrected: they state the source's acceleration, and the lower plate makes of it |T|, which is 1.01 at 10 Hz, 1.08 at
50 Hz and 1.25 at 100 Hz for `paper_3dof`.
"""

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Any, ClassVar, Protocol

import numpy as np
from satvib_common.arrays import Array
from satvib_common.errors import SatvibError
from satvib_common.schema import Schema, param

from satvib_plant_sim.disturbance.window import Window

Transfer = Callable[[float], float]

UPWARD = (0.0, 0.0, 1.0, 0.0, 0.0, 0.0)

# of the highest frequency, on the grid of the truth: less would make a tone lower by more than 0.2 %
POINTS_PER_PERIOD = 40


class Bank(Protocol):
    """Disturbances of one kind, one per row."""

    def evaluate(self, first: int, grid: Array) -> Array:
        """Give the values (rows, len(grid)) at the fine indices first + grid."""
        ...


@dataclass(frozen=True)
class Clock:
    """Fine time: `period` in s."""

    period: float

    def index(self, t: float | None) -> float:
        """Fine index nearest to t (s); None is never."""
        return np.inf if t is None else float(round(t / self.period))

    def window(self, settings: 'Disturbance') -> list[float]:
        """Give the times of a disturbance (3), `Window`."""
        times = {
            Window.START: self.index(settings.start),
            Window.STOP: self.index(settings.stop),
            Window.PERIOD: self.period,
        }
        return [times[slot] for slot in Window]


@dataclass(frozen=True, kw_only=True)
class Disturbance(Schema):
    """Base of the kinds; each is a sibling file.

    Subclasses give `values()`, the numbers of their kernel, and `KERNEL`, which takes the times (w), `Window`, the
    values (p), first () and grid (f), and gives the disturbance (f) at the fine indices first + grid.
    """

    kind: str = param(description='kind')
    start: float = param(0.0, 'begins', unit='s', minimum=0.0)
    stop: float | None = param(None, 'ends; none: never', unit='s')
    target: str = param('base', 'what it acts on', choices=('base', 'payload'))
    direction: tuple[float, ...] = param(
        (), 'factors along x, y, z, or along and about them; none: along z'
    )

    KERNEL: ClassVar[Any] = None

    def check(self) -> None:
        """Refuse an end before the beginning, and a direction that is none."""
        if self.stop is not None and self.stop <= self.start:
            raise SatvibError(f'stop: {self.stop} s is not after start, {self.start} s')
        if self.direction and (len(self.direction) not in {3, 6} or not any(self.direction)):
            raise SatvibError('direction: 3 or 6 numbers are expected, not all of them 0')

    def weights(self, directions: int) -> tuple[float, ...]:
        """Give the factors in the directions of a rig, 1 (along z) or 6.

        Raises:
            SatvibError: the rig has no such direction.
        """
        given = (*self.direction, 0.0, 0.0, 0.0)[:6] if self.direction else UPWARD
        if directions == 6:
            return given
        if any(given[:2]) or any(given[3:]):
            shown = ', '.join(f'{d:g}' for d in self.direction)
            raise SatvibError(
                f'disturbance: direction: {shown}: the struts of this rig stand on a circle; it moves along z alone; '
                'a rig that lists its struts has six directions'
            )
        return (given[2],)

    def tones(self) -> tuple[float, ...]:
        """Give the fixed frequencies, Hz; empty for a kind without any."""
        return ()

    def highest(self) -> tuple[str, float]:
        """Give the key that sets the highest frequency, and that frequency, Hz; 0 for a kind without any."""
        return 'frequency', max(self.tones(), default=0.0)

    def check_grid(self, fine_rate: float) -> None:
        """Refuse frequencies that a grid of points cannot hold; between its points it is a straight line.

        Args:
            fine_rate: Hz, points per second.

        Raises:
            SatvibError: a frequency at or above half of that.
        """
        for part in self.parts():
            key, frequency = part.highest()
            if not frequency < 0.5 * fine_rate:
                raise SatvibError(
                    f'disturbance: {key}: {frequency} Hz is not below {0.5 * fine_rate} Hz, half the '
                    'rate of the truth (rig.acquisition.fine_rate)'
                )

    def check_points(self, fine_rate: float) -> None:
        """Refuse frequencies for which a grid is too coarse, so that no amplitude is lower than it says.

        Raises:
            SatvibError: a frequency with fewer than `POINTS_PER_PERIOD` points in a period.
        """
        self.check_grid(fine_rate)
        for part in self.parts():
            key, frequency = part.highest()
            if POINTS_PER_PERIOD * frequency > fine_rate * (1.0 + 1e-9):
                raise SatvibError(
                    f'disturbance: {key}: {frequency} Hz needs a truth of {POINTS_PER_PERIOD * frequency:g} points '
                    f'per second, this rig has {fine_rate:g}; fitted_grid gives one that fits'
                )

    def parts(self) -> tuple['Disturbance', ...]:
        """Give the disturbances that add up to this one."""
        return (self,)

    def values(self, transfer: Transfer) -> Sequence[float]:
        """Give the kernel's numbers; `transfer(f)` is |T| at f Hz (1 for a force)."""
        raise NotImplementedError

    @classmethod
    def bank(
        cls,
        settings: Sequence['Disturbance'],
        seeds: Sequence[tuple[int, ...]],  # noqa: ARG003 - for the kinds that draw
        clock: Clock,
        transfers: Sequence[Transfer],
    ) -> Bank:
        """Put disturbances of this kind, one per row, into one evaluator.

        Each row's seed is a tuple, the beginning of what `default_rng` takes.
        """
        windows = np.array([clock.window(s) for s in settings])
        rows = [list(s.values(t)) for s, t in zip(settings, transfers, strict=True)]
        width = max(len(row) for row in rows)
        values = np.array([row + [0.0] * (width - len(row)) for row in rows])
        return KernelBank(cls.KERNEL, windows, values)


class KernelBank:
    """Evaluates a kernel over its rows."""

    def __init__(self, function: Any, windows: Array, values: Array) -> None:
        self._function = function
        self._windows, self._values = windows, values

    def evaluate(self, first: int, grid: Array) -> Array:
        """Give the values (rows, len(grid)) at the fine indices first + grid."""
        result: Array = self._function(self._windows, self._values, float(first), grid)
        return result
