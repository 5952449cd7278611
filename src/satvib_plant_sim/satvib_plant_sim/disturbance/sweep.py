# SPDX-FileCopyrightText: 2026 The satvib authors
# SPDX-License-Identifier: Apache-2.0
"""A tone that moves: a sin(phi(t)) from f_0 to f_1 in D seconds, then at f_1.

Linear: phi = 2 pi (f_0 t + (f_1 - f_0) t^2 / (2 D)). Logarithmic: phi = 2 pi f_0 D / ln r (r^(t/D) - 1), r = f_1 / f_0.
The phase goes on without a jump when the sweep ends.

A stepped sine stays at each of its frequencies for a while, and goes on to the next one without a jump of its phase.
"""

import math
from dataclasses import dataclass
from typing import ClassVar, NamedTuple

from satvib_common.errors import SatvibError
from satvib_common.kernels.compile import Kernel, kernel
from satvib_common.schema import param

from satvib_plant_sim.disturbance.base import Disturbance, Transfer
from satvib_plant_sim.disturbance.window import acts, elapsed


class SweepValues(NamedTuple):
    """Numbers of a sweep: m/s^2 (N), f_0 and f_1 in Hz, D in s, ln r (0: linear)."""

    amplitude: float
    begin: float
    end: float
    duration: float
    log_ratio: float


@kernel('void(f8[:],f8[:],f8,f8[:],f8[:])', '(w),(p),(),(f)->(f)')
def sweep_values(window, p, first, grid, out):
    """Give a sweep; p is `SweepValues`."""
    s = SweepValues(p[0], p[1], p[2], p[3], p[4])
    for j in range(grid.shape[0]):
        n = first + grid[j]
        out[j] = 0.0
        if acts(window, n):
            t = elapsed(window, n)
            swept = min(t, s.duration)
            if s.log_ratio == 0.0:
                change = s.end - s.begin
                turns = s.begin * swept + 0.5 * change * swept * swept / s.duration
            else:
                growth = math.exp(s.log_ratio * swept / s.duration) - 1.0
                turns = s.begin * s.duration / s.log_ratio * growth
            turns += s.end * (t - swept)
            out[j] = s.amplitude * math.sin(2.0 * math.pi * turns)


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
        """Refuse a logarithmic sweep without a change of frequency."""
        super().check()
        if self.shape == 'log' and self.frequency == self.end_frequency:
            raise SatvibError('end_frequency: a log sweep needs another one than frequency')

    def highest(self) -> tuple[str, float]:
        """Give the higher end."""
        ends = {'frequency': self.frequency, 'end_frequency': self.end_frequency}
        return max(ends.items(), key=lambda end: end[1])

    def values(self, transfer: Transfer) -> SweepValues:  # noqa: ARG002 - no fixed frequency
        """The numbers of the sweep."""
        log = math.log(self.end_frequency / self.frequency) if self.shape == 'log' else 0.0
        return SweepValues(
            amplitude=self.amplitude,
            begin=self.frequency,
            end=self.end_frequency,
            duration=self.duration,
            log_ratio=log,
        )


class StepValues(NamedTuple):
    """Numbers of a stepped sine: m/s^2 (N), first frequency in Hz, ln of the ratio of neighbours, steps, s a step."""

    amplitude: float
    begin: float
    log_ratio: float
    steps: float
    dwell: float


@kernel('void(f8[:],f8[:],f8,f8[:],f8[:])', '(w),(p),(),(f)->(f)')
def step_values(window, p, first, grid, out):
    """Give a stepped sine; p is `StepValues`."""
    s = StepValues(p[0], p[1], p[2], p[3], p[4])
    # turns of the steps that are over; neighbours on the grid share them
    counted, over = 0, 0.0
    for j in range(grid.shape[0]):
        n = first + grid[j]
        out[j] = 0.0
        if acts(window, n):
            t = elapsed(window, n)
            step = math.floor(t / s.dwell)
            if step < s.steps:
                if int(step) < counted:
                    counted, over = 0, 0.0
                for i in range(counted, int(step)):
                    over += s.begin * math.exp(s.log_ratio * i) * s.dwell
                counted = int(step)
                turns = over + s.begin * math.exp(s.log_ratio * step) * (t - step * s.dwell)
                out[j] = s.amplitude * math.sin(2.0 * math.pi * turns)


@dataclass(frozen=True, kw_only=True)
class SteppedSine(Disturbance):
    """A tone that stays at each of several frequencies, evenly spaced on a logarithmic axis."""

    kind: str = param('stepped_sine', 'kind', choices=('stepped_sine',))
    amplitude: float = param(description='of the source', unit='m/s^2 (N)')
    frequency: float = param(description='of the first step', unit='Hz', above=0.0)
    end_frequency: float = param(description='of the last step', unit='Hz', above=0.0)
    steps: int = param(description='how many frequencies', minimum=2, maximum=10_000)
    dwell: float = param(description='time at each frequency', unit='s', above=0.0)

    KERNEL: ClassVar[Kernel] = step_values

    def frequencies(self) -> tuple[float, ...]:
        """Give the frequency of every step, Hz."""
        v = self.values(abs)
        return tuple(v.begin * math.exp(v.log_ratio * i) for i in range(self.steps))

    def highest(self) -> tuple[str, float]:
        """Give the higher end."""
        ends = {'frequency': self.frequency, 'end_frequency': self.end_frequency}
        return max(ends.items(), key=lambda end: end[1])

    def values(self, transfer: Transfer) -> StepValues:  # noqa: ARG002 - as of a sweep
        """The numbers of the steps."""
        return StepValues(
            amplitude=self.amplitude,
            begin=self.frequency,
            log_ratio=math.log(self.end_frequency / self.frequency) / (self.steps - 1),
            steps=float(self.steps),
            dwell=self.dwell,
        )
