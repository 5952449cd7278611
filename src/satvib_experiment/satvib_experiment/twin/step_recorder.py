# SPDX-FileCopyrightText: 2026 The satvib authors
# SPDX-License-Identifier: Apache-2.0
"""Records what the offline twin does, in the fields of the messages that the live graph would publish."""

from __future__ import annotations

from collections.abc import Collection, Mapping, Sequence
from dataclasses import fields
from typing import Any

import numpy as np
from numpy.typing import NDArray
from satvib_common.phases import PhasePlan
from satvib_common.struts.names import strut_names
from satvib_control.laws.reasons import text_of
from satvib_plant_sim.plant.failures import CONTROLLER, Failure
from satvib_plant_sim.plant.observation import Sample, Truth
from satvib_plant_sim.rig.any_rig import AnyRig

from satvib_experiment.recording.recording import Group, Recording
from satvib_experiment.scenario.scenario import Scenario
from satvib_experiment.twin.step import LoopStep

SPOKEN = ('voltage', 'state')  # what a controller publishes, as long as it runs


def _plain(name: str, array: NDArray[Any]) -> NDArray[Any]:
    """Give a field as the message holds it: texts for codes, matrices row by row."""
    if name == 'reason' and array.dtype.kind == 'i':
        codes, inverse = np.unique(array, return_inverse=True)
        return np.array([text_of(code) for code in codes])[inverse.reshape(array.shape)]
    if array.dtype == object:
        return array.astype(str)
    return array.reshape(*array.shape[:2], -1) if array.ndim > 3 else array


def _fields(observed: Sample | Truth) -> dict[str, Any]:
    """Give the arrays of what a plant gives, by name; they are named as in the messages."""
    return {f.name: getattr(observed, f.name) for f in fields(observed) if f.name != 'sequence'}


class StepRecorder:
    """Arrays of (samples, *shape, struts, ...), filled sample by sample.

    Args:
        plan: phases by sample.
        shape: () of one scenario, (trials,) of a batch.
        dt: s.
        truth: keep the fine samples of the truth.
        keep: the groups ('acceleration') and fields ('truth.stroke') that are kept; None: all.
    """

    def __init__(
        self,
        plan: PhasePlan,
        shape: tuple[int, ...],
        dt: float,
        truth: bool = True,
        keep: Collection[str] | None = None,
    ) -> None:
        self.plan, self.shape, self.dt, self.truth = plan, shape, dt, truth
        self.keep = keep
        self._arrays: dict[tuple[str, str], NDArray[Any]] = {}

    def add(self, step: LoopStep) -> None:
        """Take one sample."""
        k = step.sequence
        self._put(k, 'acceleration', _fields(step.sample))
        self._put(k, 'voltage', step.output.voltages())
        self._put(k, 'model', step.identification.figures())
        self._put(k, 'state', step.output.figures())
        if self.truth:
            self._put(k, 'truth', _fields(step.truth))

    def _put(self, k: int, group: str, figures: Mapping[str, Any]) -> None:
        for name, values in figures.items():
            if not (self.keep is None or group in self.keep or f'{group}.{name}' in self.keep):
                continue
            value = np.asarray(values)
            array = self._arrays.get((group, name))
            if array is None:
                array = np.zeros((self.plan.end, *value.shape), dtype=value.dtype)
                self._arrays[group, name] = array
            array[k] = value

    def recordings(self, scenarios: Sequence[Scenario], rigs: Sequence[AnyRig]) -> list[Recording]:
        """Give one recording per trial, of its scenario and rig."""
        return [
            self._recording(trial, scenario, rig)
            for trial, (scenario, rig) in enumerate(zip(scenarios, rigs, strict=True))
        ]

    def _recording(self, trial: int, scenario: Scenario, rig: AnyRig) -> Recording:
        groups: dict[str, Group] = {}
        for (group, name), array in self._arrays.items():
            picked = array[:, trial] if self.shape else array
            groups.setdefault(group, {})[name] = _plain(name, picked)
        end, dt = self.plan.end, self.dt
        struts = groups['acceleration']['upper'].shape[1]
        for group, arrays in groups.items():
            arrays['present'] = np.ones((end, struts), dtype=bool)
            if group in SPOKEN:
                _silence(arrays, scenario.failures, dt)
        return Recording(
            struts=strut_names(struts),
            sample_period=dt,
            plan=self.plan,
            sequence=np.arange(end, dtype=np.int64),
            stamp=np.array([round(k * dt * 1e9) for k in range(end)], dtype=np.int64),
            groups=groups,
            scenario=scenario,
            rig=rig,
            seed=scenario.seed,
            source=f'simulation of {scenario.name}',
        )


def _silence(arrays: Group, failures: Sequence[Failure], dt: float) -> None:
    """Leave out what a controller would have published after it was killed."""
    for failure in failures:
        if failure.kind != CONTROLLER:
            continue
        struts = slice(None) if failure.strut == 0 else slice(failure.strut - 1, failure.strut)
        for name, values in arrays.items():
            late = values[failure.sample(dt) :, struts]
            if name == 'present':
                late[...] = False
            elif values.dtype.kind == 'f':
                late[...] = np.nan
