# SPDX-FileCopyrightText: 2026 The satvib authors
# SPDX-License-Identifier: Apache-2.0
"""The disturbances of all trials of a plant, evaluated together."""

from collections import defaultdict
from collections.abc import Sequence
from functools import partial
from typing import Any

import numpy as np
from numpy.typing import NDArray
from satvib_common.arrays import Array

from satvib_plant_sim.disturbance.base import Bank, Clock, Disturbance, Transfer
from satvib_plant_sim.rig.streams import Stream


def _unity(_: float) -> float:
    return 1.0


def _along(transfer: Any, factors: tuple[float, ...]) -> Transfer:
    """Give the transfer along a direction; a rig of one direction has one."""
    return transfer if len(factors) == 1 else partial(transfer, direction=factors)


class Mixer:
    """Adds up each trial's parts, in the order of the parts; the other trials change nothing.

    Args:
        disturbances, seeds, transfers: one per trial. A transfer takes Hz, and in a rig of six directions the factors
            of the direction as well.
        fine_period: s.
        n_fine: fine steps per sample period.
        directions: of the base and of the payload, 1 (along z) or 6.

    Raises:
        SatvibError: a direction that the rig does not have.
    """

    def __init__(
        self,
        disturbances: Sequence[Disturbance],
        seeds: Sequence[int],
        transfers: Sequence[Any],
        fine_period: float,
        n_fine: int,
        directions: tuple[int, int] = (1, 1),
    ) -> None:
        base, payload = directions
        groups: dict[tuple[int, type[Disturbance], int], list[tuple[int, Disturbance]]]
        groups = defaultdict(list)
        for trial, disturbance in enumerate(disturbances):
            for order, part in enumerate(disturbance.parts()):
                channel = int(part.target == 'payload')
                groups[order, type(part), channel].append((trial, part))
        clock = Clock(fine_period)
        self._banks: list[tuple[NDArray[np.intp] | slice, slice, Array, Bank]] = []
        forces = False
        for (order, kind, channel), members in sorted(groups.items(), key=lambda g: g[0][0]):
            trials = [trial for trial, _ in members]
            weights = [part.weights(payload if channel else base) for _, part in members]
            bank = kind.bank(
                [part for _, part in members],
                [(seeds[trial], Stream.DISTURBANCE, order) for trial in trials],
                clock,
                [
                    _unity if channel else _along(transfers[trial], factors)
                    for trial, factors in zip(trials, weights, strict=True)
                ],
            )
            everywhere = trials == list(range(len(disturbances)))
            where = slice(None) if everywhere else np.array(trials, dtype=np.intp)
            rows = slice(base, base + payload) if channel else slice(0, base)
            self._banks.append((where, rows, np.array(weights)[:, :, None], bank))
            forces |= bool(channel)
        self.channels = base + payload * forces
        self._n_fine = n_fine
        self._grid = np.arange(n_fine + 1, dtype=float)
        self._trials = len(disturbances)

    def period(self, k: int) -> Array:
        """Give the values (trials, channels, n_fine + 1) on the fine grid from sample k to sample k + 1.

        The channels are the directions of the base, then, where anything acts on the payload, those of the payload.
        """
        values = np.zeros((self._trials, self.channels, self._n_fine + 1))
        for trials, rows, weights, bank in self._banks:
            values[trials, rows] += weights * bank.evaluate(k * self._n_fine, self._grid)[:, None]
        return values
