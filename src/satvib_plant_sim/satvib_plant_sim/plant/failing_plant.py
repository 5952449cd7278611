# SPDX-FileCopyrightText: 2026 The satvib authors
# SPDX-License-Identifier: Apache-2.0
"""A plant with failures at given samples; apart from them it behaves as the plant that it wraps.

    plant = make_failing_plant(rig, disturbance, seed, failures)     # or a list of each for a batch

A trial has the bits of its single run; failures of other trials change nothing.
"""

from __future__ import annotations

from collections import defaultdict
from collections.abc import Sequence
from dataclasses import replace
from typing import Any

import numpy as np
from numpy.typing import ArrayLike
from satvib_common.arrays import Array, Mask
from satvib_common.errors import SatvibError

from satvib_plant_sim.disturbance.base import Disturbance
from satvib_plant_sim.disturbance.factory import make_disturbance
from satvib_plant_sim.plant.any_plant import AnyPlant, make_plant
from satvib_plant_sim.plant.failures import ACTUATOR, CONTROLLER, DISTURBANCE, RIG, SENSOR, Failure
from satvib_plant_sim.plant.observation import Sample, Truth
from satvib_plant_sim.plant.plant import Plant
from satvib_plant_sim.rig.any_rig import AnyRig

COMMAND_TIMEOUT = 0.05  # s, that of the plant's node


class FailingPlant:
    """A plant with failures, with the interface of `Plant`.

    Args:
        plant: the plant as it begins.
        failures: of each trial; one list for a plant of shape ().
        timeout: s, how long the board holds the voltage of a silent controller.

    Attributes:
        dead: (*shape, struts) where the controller is killed.
    """

    def __init__(
        self,
        plant: AnyPlant,
        failures: Sequence[Sequence[Failure]],
        timeout: float = COMMAND_TIMEOUT,
    ) -> None:
        self.plant = plant
        self.shape, self.struts, self.dt = plant.shape, plant.struts, plant.dt
        self.n_fine, self.fine_period = plant.n_fine, plant.fine_period
        self._events: dict[int, list[tuple[int, Failure]]] = defaultdict(list)
        for trial, each in enumerate(failures):
            for failure in each:
                self._events[failure.sample(plant.dt)].append((trial, failure))
        flat = (len(failures), plant.struts)
        self._rigs: list[AnyRig] = list(plant.rigs)
        self._blind, self._dead = np.zeros(flat, dtype=bool), np.zeros(flat, dtype=bool)
        self._held, self._silent = np.zeros(flat), np.zeros(flat)
        self._timeout = max(round(timeout / plant.dt), 1)

    @property
    def sequence(self) -> int:
        """Index of the present sample."""
        return self.plant.sequence

    @property
    def terminal_voltage(self) -> Array:
        """What stands at the terminals (*shape, struts), V."""
        return self.plant.terminal_voltage

    @property
    def dead(self) -> Mask:
        """Where (*shape, struts) the controller is killed."""
        return self._dead.reshape(*self.shape, self.struts)

    def sample(self) -> Sample:
        """Read the present sample; asking again gives the same."""
        self._happen(self.plant.sequence)
        sample = self.plant.sample()
        if not self._blind.any():
            return sample
        blind = self._blind.reshape(*self.shape, self.struts)
        return replace(
            sample,
            upper=np.where(blind, np.nan, sample.upper),
            upper_clipped=sample.upper_clipped & ~blind,
        )

    def advance(self, voltage: ArrayLike, arrival: ArrayLike | None = None) -> Truth:
        """Go on to the next sample; voltages of killed controllers are ignored."""
        self._happen(self.plant.sequence)
        if self._dead.any():
            asked = np.asarray(voltage, dtype=float).reshape(self._dead.shape)
            self._silent = np.where(self._dead, self._silent + 1.0, 0.0)
            over = self._dead & (self._silent >= self._timeout)
            held = np.where(self._dead, self._held, asked)
            self._held = np.where(over, 0.0, held)
            voltage = self._held.reshape(*self.shape, self.struts)
        else:
            held = np.asarray(voltage, dtype=float).reshape(self._dead.shape)
            self._held = held
        return self.plant.advance(voltage, arrival)

    def _happen(self, k: int) -> None:
        """Apply the failures of sample k, once."""
        if k not in self._events:
            return
        rigs: dict[int, AnyRig] = {}
        shaken: dict[int, Disturbance] = {}
        for trial, failure in self._events.pop(k):
            index: Any = failure.strut - 1 if failure.strut else slice(None)
            if failure.kind == SENSOR:
                self._blind[trial, index] = True
            elif failure.kind == CONTROLLER:
                self._dead[trial, index] = True
            elif failure.kind == DISTURBANCE:
                shaken[trial] = make_disturbance(failure.disturbance)
            elif failure.kind in {ACTUATOR, RIG}:
                self._rigs[trial] = rigs[trial] = failure.apply(self._rigs[trial])
        if not rigs and not shaken:
            return
        if not isinstance(self.plant, Plant):
            raise SatvibError('failures: a rig of identified models cannot change in a run')
        self.plant.change(rigs, shaken)  # type: ignore[arg-type]


def make_failing_plant(
    rig: AnyRig | Sequence[AnyRig],
    disturbance: Disturbance | Sequence[Disturbance],
    seed: int | Sequence[int],
    failures: Sequence[Failure] | Sequence[Sequence[Failure]],
    timeout: float = COMMAND_TIMEOUT,
) -> AnyPlant | FailingPlant:
    """Give a plant, wrapped only when it has failures.

    Args:
        rig, disturbance, seed: as for `make_plant`.
        failures: one list for a plant of shape (), else a list for each trial.
        timeout: s; see `FailingPlant`.
    """
    plant = make_plant(rig, disturbance, seed)
    lists: list[Sequence[Failure]]
    lists = [list(failures)] if plant.shape == () else [list(f) for f in failures]  # type: ignore[arg-type]
    if not any(lists):
        return plant
    return FailingPlant(plant, lists, timeout)
