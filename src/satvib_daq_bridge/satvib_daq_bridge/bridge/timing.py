# SPDX-FileCopyrightText: 2026 The satvib authors
# SPDX-License-Identifier: Apache-2.0
"""How well the loop keeps its time: lateness of the samples, latency of the voltages, deadlines missed."""

from collections import deque

import numpy as np

_RECENT = 4096


class Timing:
    """Running figures of a loop.

    Args:
        period: s, sample period.

    Attributes:
        missed: samples in ACTIVE whose voltages left after the next sample, or not at all.
        latest, slowest: s, the worst lateness and latency so far.
    """

    def __init__(self, period: float) -> None:
        self.period = period
        self.missed = 0
        self.latest = 0.0
        self.slowest = 0.0
        self._late: deque[float] = deque(maxlen=_RECENT)
        self._latency: deque[float] = deque(maxlen=_RECENT)

    def add(self, late: float, latency: float) -> None:
        """Take one sample: how late it was there, and how long its predecessor's voltages took (NaN: none left)."""
        self._late.append(late)
        self.latest = max(self.latest, late)
        if latency == latency:
            self._latency.append(latency)
            self.slowest = max(self.slowest, latency)

    def figures(self) -> dict[str, float]:
        """Percentiles of the recent samples and the worst so far, in ms."""
        found = {'deadlines missed': float(self.missed)}
        for name, values, worst in (
            ('sample late', self._late, self.latest),
            ('voltage latency', self._latency, self.slowest),
        ):
            if values:
                p50, p99 = np.percentile(values, [50, 99]) * 1e3
                found |= {
                    f'{name} p50 [ms]': float(p50),
                    f'{name} p99 [ms]': float(p99),
                    f'{name} max [ms]': worst * 1e3,
                }
        return found
