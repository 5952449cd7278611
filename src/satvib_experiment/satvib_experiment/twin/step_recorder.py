# SPDX-FileCopyrightText: 2026 The satvib authors
# SPDX-License-Identifier: Apache-2.0
"""Takes down what the offline twin does, in the fields of the messages that the live graph would publish."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np
from numpy.typing import NDArray
from satvib_common.phases import PhasePlan
from satvib_control.laws.base import STATE_FIELDS
from satvib_control.laws.reasons import text_of
from satvib_plant_sim.plant.failures import CONTROLLER, Failure
from satvib_plant_sim.rig.any_rig import AnyRig

from satvib_experiment.recording.recording import Group, Recording
from satvib_experiment.scenario.scenario import Scenario
from satvib_experiment.twin.step import LoopStep

SAMPLE = ('upper', 'lower')
VOLTAGE = ('voltage', 'saturated', 'fault')
MODEL = (
    'a', 'b', 'standard_deviation', 'covariance', 'prediction_error', 'noise_variance', 'bias',
    'updates', 'excitation_order', 'information_eigenvalue', 'information_condition', 'whiteness',
    'pole_modulus', 'converged', 'reasons',
)  # fmt: skip
OUTPUT = (
    'reference', 'output', 'voltage', 'upper_rms', 'bias_upper', 'bias_lower', 'adapting',
    'saturated', 'fault', 'reason',
)  # fmt: skip
SPOKEN = ('voltage', 'state')  # what a controller says, as long as it lives
TRUTH = ('upper', 'lower', 'stroke', 'stroke_peak', 'force_peak', 'current')


# fields whose name in the message is another
_NAMES = {'reasons': 'reason'}


def _plain(name: str, array: NDArray[Any]) -> NDArray[Any]:
    """Give a field as the message holds it: texts for codes, matrices row by row."""
    if name == 'reason':
        codes, inverse = np.unique(array, return_inverse=True)
        return np.array([text_of(code) for code in codes])[inverse.reshape(array.shape)]
    if name == 'reasons':
        return array.astype(str)
    if name == 'covariance':
        return array.reshape(*array.shape[:-2], -1)
    return array


class StepRecorder:
    """Arrays of (samples, *shape, struts, ...), filled sample by sample.

    Args:
        plan: phases by sample.
        shape: () of one scenario, (trials,) of a batch.
        dt: s.
        truth: keep the fine samples of the truth.
    """

    def __init__(
        self, plan: PhasePlan, shape: tuple[int, ...], dt: float, truth: bool = True
    ) -> None:
        self.plan, self.shape, self.dt, self.truth = plan, shape, dt, truth
        self._arrays: dict[tuple[str, str], NDArray[Any]] = {}

    def add(self, step: LoopStep) -> None:
        """Take down one sample."""
        k = step.sequence
        self._put(k, 'acceleration', SAMPLE, step.sample)
        self._put(k, 'voltage', VOLTAGE, step.output)
        self._put(k, 'model', MODEL, step.identification)
        self._put(k, 'state', OUTPUT, step.output)
        self._put(k, 'state', STATE_FIELDS, step.output.state, skip=OUTPUT)
        if self.truth:
            self._put(k, 'truth', TRUTH, step.truth)

    def _put(
        self, k: int, group: str, names: tuple[str, ...], values: Any, skip: tuple[str, ...] = ()
    ) -> None:
        for name in names:
            if name in skip:
                continue
            value = np.asarray(getattr(values, name))
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
            groups.setdefault(group, {})[_NAMES.get(name, name)] = _plain(name, picked)
        end, dt = self.plan.end, self.dt
        struts = groups['acceleration']['upper'].shape[1]
        for group, fields in groups.items():
            fields['present'] = np.ones((end, struts), dtype=bool)
            if group in SPOKEN:
                _silence(fields, scenario.failures, dt)
        return Recording(
            struts=tuple(f'strut_{i + 1}' for i in range(struts)),
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


def _silence(fields: Group, failures: Sequence[Failure], dt: float) -> None:
    """Leave out what a controller would have said after it was killed."""
    for failure in failures:
        if failure.kind != CONTROLLER:
            continue
        struts = slice(None) if failure.strut == 0 else slice(failure.strut - 1, failure.strut)
        for name, values in fields.items():
            late = values[failure.sample(dt) :, struts]
            if name == 'present':
                late[...] = False
            elif values.dtype.kind == 'f':
                late[...] = np.nan
