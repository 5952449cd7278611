# SPDX-FileCopyrightText: 2026 The satvib authors
# SPDX-License-Identifier: Apache-2.0
"""The disturbances of all trials of a plant, evaluated together."""

from collections import defaultdict
from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray
from satvib_common.arrays import Array

from satvib_plant_sim.disturbance.base import Bank, Clock, Disturbance, Transfer
from satvib_plant_sim.rig.streams import Stream


def _unity(_: float) -> float:
    return 1.0


class Mixer:
    """Adds up each trial's parts, in the order of the parts; the other trials change nothing.

    Args:
        disturbances, seeds, transfers: one per trial.
        fine_period: s.
        n_fine: fine steps per sample period.
    """

    def __init__(
        self,
        disturbances: Sequence[Disturbance],
        seeds: Sequence[int],
        transfers: Sequence[Transfer],
        fine_period: float,
        n_fine: int,
    ) -> None:
        groups: dict[tuple[int, type[Disturbance], int], list[tuple[int, Disturbance]]]
        groups = defaultdict(list)
        for trial, disturbance in enumerate(disturbances):
            for order, part in enumerate(disturbance.parts()):
                channel = int(part.target == 'payload')
                groups[order, type(part), channel].append((trial, part))
        clock = Clock(fine_period)
        self._banks: list[tuple[NDArray[np.intp] | slice, int, Bank]] = []
        for (order, kind, channel), members in sorted(groups.items(), key=lambda g: g[0][0]):
            trials = [trial for trial, _ in members]
            bank = kind.bank(
                [part for _, part in members],
                [(seeds[trial], Stream.DISTURBANCE, order) for trial in trials],
                clock,
                [_unity if channel else transfers[trial] for trial in trials],
            )
            everywhere = trials == list(range(len(disturbances)))
            where = slice(None) if everywhere else np.array(trials, dtype=np.intp)
            self._banks.append((where, channel, bank))
        self.channels = 1 + any(channel for _, channel, _ in self._banks)
        self._n_fine = n_fine
        self._grid = np.arange(n_fine + 1, dtype=float)
        self._trials = len(disturbances)

    def period(self, k: int) -> Array:
        """Give the values (trials, channels, n_fine + 1) on the fine grid from sample k to sample k + 1."""
        values = np.zeros((self._trials, self.channels, self._n_fine + 1))
        for trials, channel, bank in self._banks:
            values[trials, channel] += bank.evaluate(k * self._n_fine, self._grid)
        return values
