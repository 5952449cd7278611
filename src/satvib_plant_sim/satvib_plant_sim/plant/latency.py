# SPDX-FileCopyrightText: 2026 The satvib authors
# SPDX-License-Identifier: Apache-2.0
"""The voltages on their way: what a rig's latency keeps back, whole periods and a part of a period."""

from collections.abc import Sequence

import numpy as np
from satvib_common.arrays import Array

from satvib_plant_sim.rig.rig import Rig
from satvib_plant_sim.stepping.discretize import Delay
from satvib_plant_sim.stepping.hold import events_at

NEVER = np.iinfo(np.int64).min // 2


class VoltageQueue:
    """The voltages of the last periods.

    Args:
        rigs, delays: one per trial.
        n: struts.
    """

    def __init__(self, rigs: Sequence[Rig], delays: Sequence[Delay], n: int) -> None:
        self._periods = np.array(
            [_whole_periods(rig, delay) for rig, delay in zip(rigs, delays, strict=True)]
        )
        self._event = np.stack([_events(delay, n) for delay in delays])
        # sample of the last voltage that had arrived when the latency changed: none before it arrives any more
        self._arrived = np.full_like(self._periods, NEVER)
        self._queue = np.zeros((int(self._periods.max()) + 1, len(rigs), n))

    def pass_on(self, k: int, voltage: Array) -> tuple[Array, Array]:
        """Take the voltages (trials, n) of sample k.

        Returns:
            The voltages (trials, n) that arrive in period k, and when (trials, n, 2), `EventSlot`.
        """
        depth, trials, n = self._queue.shape
        self._queue[k % depth] = voltage
        if depth == 1:  # nothing is later than its own period
            return self._queue[0], self._event
        sent = np.maximum(k - self._periods, self._arrived) % depth
        return self._queue[sent, np.arange(trials)[:, None], np.arange(n)], self._event

    def change(self, trial: int, rig: Rig, delay: Delay, k: int) -> None:
        """Change the latency of a trial before sample k.

        Voltages on their way keep their order: where the latency grows, the last one that has arrived stays until the
        next arrives. What the queue holds from before that depends on the longest latency of the batch.
        """
        self._arrived[trial] = np.maximum(k - 1 - self._periods[trial], self._arrived[trial])
        self._periods[trial] = periods = _whole_periods(rig, delay)
        self._event[trial] = _events(delay, self._queue.shape[-1])
        depth, longer = len(self._queue), max(periods) + 1
        if longer > depth:
            queue = np.zeros((longer, *self._queue.shape[1:]))
            for age in range(1, depth + 1):
                queue[(k - age) % longer] = self._queue[(k - age) % depth]
            self._queue = queue


def measured_events(arrival: Array, fine_period: float, n_fine: int) -> Array:
    """Give the events (..., 2) of measured arrivals (...), s, on the fine grid; NaN is never."""
    steps = np.clip(np.rint(arrival / fine_period), 0.0, n_fine)
    return events_at(np.where(np.isnan(arrival), -1.0, steps), np.zeros(arrival.shape))


def _events(delay: Delay, n: int) -> Array:
    return events_at(np.full(n, float(delay.step)), np.full(n, float(delay.at_theta)))


def _whole_periods(rig: Rig, delay: Delay) -> list[int]:
    """Give the whole periods by which the voltage of each strut is late."""
    late, count = rig.acquisition.periods_late, rig.struts.count
    return [delay.periods + each for each in (late if len(late) == count else late * count)]
