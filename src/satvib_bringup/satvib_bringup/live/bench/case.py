# SPDX-FileCopyrightText: 2026 The satvib authors
# SPDX-License-Identifier: Apache-2.0
"""What is measured: the cases, and the figures of one run."""

from collections.abc import Sequence
from dataclasses import dataclass, field
from typing import Any

import numpy as np
from satvib_common.arrays import Array

# the bare graph has processes as `separate` and `strut` have
FLOORS = ('separate', 'strut')
COMPOSITIONS = ('separate', 'strut', 'single')


@dataclass(frozen=True)
class Case:
    """One graph at one rate.

    Attributes:
        struts: how many.
        rate: Hz, of the samples in real time.
        realtime: samples follow the clock; otherwise lockstep.
        floors, compositions: of the bare graph and of satvib; the first floor is what ratios refer to.
        seconds: length of the experiment.
    """

    struts: int
    rate: float
    realtime: bool
    floors: tuple[str, ...]
    compositions: tuple[str, ...]
    seconds: float

    @property
    def name(self) -> str:
        """For people."""
        return f'{self.struts} struts, ' + (f'{self.rate:g} Hz' if self.realtime else 'lockstep')


@dataclass
class Figures:
    """What one run showed.

    Attributes:
        samples_per_s: in lockstep.
        cpu: ms of all processes for one sample.
        cpu_of: the same by node or process.
        p50, p99, p999, most: ms from a sample to the voltage that answers it.
        late: share of the voltages that came after the next sample was due.
        missed: share of the voltages that never came.
        late_samples: samples that went out a period too late.
        start: s from the command to the first sample.
        memory: MB of the largest process; `memory_all` of all together, resident.
        failed: what went wrong; empty.
    """

    samples_per_s: float | None = None
    cpu: float | None = None
    cpu_of: dict[str, float] = field(default_factory=dict)
    p50: float | None = None
    p99: float | None = None
    p999: float | None = None
    most: float | None = None
    late: float | None = None
    missed: float | None = None
    late_samples: int | None = None
    start: float | None = None
    memory: float | None = None
    memory_all: float | None = None
    failed: str = ''

    def take_arrivals(
        self, arrivals: Array, struts: int, rate: float, first: int, samples: int
    ) -> None:
        """Take how long each voltage was on its way.

        Args:
            arrivals: (voltages, 3) strut, sample, s after the sample was published.
            struts: how many.
            rate: Hz.
            first: sample from which on they count; before it everything is cold.
            samples: of the whole run.
        """
        counted = arrivals[(arrivals[:, 1] >= first) & (arrivals[:, 1] < samples)]
        _, firsts = np.unique(counted[:, :2], axis=0, return_index=True)
        delay = counted[firsts, 2]
        wanted = struts * (samples - first)
        if len(delay) == 0:
            self.failed = 'no voltage'
            return
        self.p50, self.p99, self.p999 = (
            float(1e3 * q) for q in np.percentile(delay, [50.0, 99.0, 99.9])
        )
        self.most = float(1e3 * delay.max())
        self.late = float(np.mean(delay > 1.0 / rate))
        self.missed = max(1.0 - len(delay) / wanted, 0.0)


def quick_cases() -> list[Case]:
    """Three struts, lockstep and 200 Hz; within two minutes."""
    return [
        Case(3, 200.0, False, ('separate',), COMPOSITIONS, 12.0),
        Case(3, 200.0, True, ('separate',), COMPOSITIONS, 6.0),
    ]


def whole_cases(seconds: float = 60.0, struts: Sequence[int] = (1, 3, 6)) -> list[Case]:
    """Every composition, in lockstep and at 100 to 1000 Hz."""
    lockstep = [Case(n, 200.0, False, FLOORS, COMPOSITIONS, 20.0) for n in struts]
    clock = [
        Case(n, rate, True, FLOORS, COMPOSITIONS, seconds)
        for n in struts
        for rate in ((100.0, 200.0, 500.0, 1000.0) if n == 3 else (200.0,))
    ]
    return lockstep + clock


def medians(runs: Sequence[Figures]) -> tuple[dict[str, Any], dict[str, tuple[float, float]]]:
    """Give the median of each figure over runs, and its smallest and largest value."""
    middle: dict[str, Any] = {}
    span: dict[str, tuple[float, float]] = {}
    good = [run for run in runs if not run.failed]
    for name in FIGURES:
        values = [getattr(run, name) for run in good if getattr(run, name) is not None]
        if values:
            middle[name] = float(np.median(values))
            span[name] = (float(min(values)), float(max(values)))
    return middle, span


FIGURES = (
    'samples_per_s', 'cpu', 'p50', 'p99', 'p999', 'most', 'late', 'missed', 'late_samples',
    'start', 'memory', 'memory_all',
)  # fmt: skip
