# SPDX-FileCopyrightText: 2026 The satvib authors
# SPDX-License-Identifier: Apache-2.0
"""The offline twin: the live graph's closed loop in one process, sample for sample the same.

It drives the very cores that the nodes drive, in the order that the graph's lockstep enforces:

    for k in range(plan.end):
        sample = plant.sample()
        if plan.is_hand_over(k, model_period): controller.set_model(model stamped k - 1)
        output = controller.step(k, plan, sample.upper, sample.lower)
        supervisor.step(k, phase, sample.upper, u(k)), where there is one
        identification = identifier.step(k, phase, sample.upper, u(k - delay))
        truth  = plant.advance(output.voltage)

One scenario has the shape (struts); a list of scenarios runs as one batch of the shape (trials, struts), and every
trial has the bits of its single run.
"""

from __future__ import annotations

from collections import deque
from collections.abc import Callable, Collection, Iterator, Sequence
from dataclasses import replace

import numpy as np
from satvib_common.arrays import Array
from satvib_common.errors import SatvibError
from satvib_control.core.centralized import make_core
from satvib_control.supervision.supervisor import SupervisorCore, ask
from satvib_ident.identifier import IdentifierCore
from satvib_plant_sim.plant.failing_plant import FailingPlant, make_failing_plant
from satvib_plant_sim.rig.any_rig import AnyRig, strut_count

from satvib_experiment.recording.recording import Group, Recording
from satvib_experiment.scenario.scenario import Scenario
from satvib_experiment.twin.step import LoopStep
from satvib_experiment.twin.step_recorder import StepRecorder

Progress = Callable[[LoopStep], None]

# what the scenarios of a batch have in common
BATCH_SHARES = (
    'identifier', 'controller', 'scheme', 'supervisor', 'centralized', 'model_period', 'phases', 'duration',
    'command_timeout',
)  # fmt: skip


class ClosedLoop:
    """The loop of one scenario, or of a batch of scenarios that differ in rig, disturbance and seed.

    Args:
        scenarios: one scenario, or a list with equal phases, identifier, controller and sample rate.
        rigs: the rigs to take in place of the scenarios' own.

    Raises:
        SatvibError: scenarios that cannot run as one batch.
    """

    def __init__(
        self, scenarios: Scenario | Sequence[Scenario], rigs: Sequence[AnyRig] | None = None
    ) -> None:
        single = isinstance(scenarios, Scenario)
        self.scenarios = [scenarios] if isinstance(scenarios, Scenario) else list(scenarios)
        first = self.scenarios[0]
        self.rigs = list(rigs or (scenario.load_rig() for scenario in self.scenarios))
        rate = self.rigs[0].acquisition.sample_rate
        self.plan = first.plan(rate)
        if not single:
            self._check_batch()
        disturbances = [scenario.make_disturbance() for scenario in self.scenarios]
        seeds = [scenario.seed for scenario in self.scenarios]
        self.plant = (
            make_failing_plant(
                self.rigs[0], disturbances[0], seeds[0], first.failures, first.command_timeout
            )
            if single
            else make_failing_plant(
                self.rigs,
                disturbances,
                seeds,
                [scenario.failures for scenario in self.scenarios],
                first.command_timeout,
            )
        )
        self.shape: tuple[int, ...] = () if single else (len(self.scenarios),)
        shape = (*self.shape, self.plant.struts)
        parameters = first.identifier_parameters(rate)
        self.identifier = IdentifierCore(parameters, shape)
        self.controller = make_core(
            first.controller_parameters(rate, struts=self.plant.struts), shape
        )
        self.supervisor = (
            SupervisorCore(first.supervisor_parameters(rate, struts=self.plant.struts), shape)
            if first.supervisor
            else None
        )
        self.model_period = first.model_period
        # Before sample 0 everything is at rest at 0 V; that much is known.
        self._voltages: deque[Array] = deque(
            [np.zeros(shape)] * (parameters.delay + 1), maxlen=parameters.delay + 1
        )

    def _check_batch(self) -> None:
        first = self.scenarios[0]
        own_weights = first.controller.get('narrowband_serve') == 'payload'
        if own_weights and any(rig != self.rigs[0] for rig in self.rigs):
            raise SatvibError(
                'batch: controller.narrowband_serve: the weights of payload are those of one rig, run them one by one'
            )
        for scenario, rig in zip(self.scenarios, self.rigs, strict=True):
            for name in BATCH_SHARES:
                if getattr(scenario, name) != getattr(first, name):
                    raise SatvibError(f'batch: scenarios differ in {name}, run them one by one')
            if rig.acquisition.sample_rate != self.rigs[0].acquisition.sample_rate or strut_count(
                rig
            ) != strut_count(self.rigs[0]):
                raise SatvibError(
                    'batch: rigs differ in sample rate or struts, run them one by one'
                )

    def _known(self, voltage: Array) -> Array:
        """The voltage as an identifier receives it: NaN from a controller that was killed."""
        if not isinstance(self.plant, FailingPlant) or not self.plant.dead.any():
            return voltage
        return np.where(self.plant.dead, np.nan, voltage)

    def steps(self) -> Iterator[LoopStep]:
        """Run the whole plan, sample by sample."""
        identification = None
        for k in range(self.plan.end):
            phase = self.plan.at(k)
            sample = self.plant.sample()
            if identification is not None and self.plan.is_hand_over(k, self.model_period):
                self.controller.set_model(
                    identification.model(),
                    identification.converged,
                    identification.reasons,
                    identification.covariance,
                )
            clipped = sample.upper_clipped, sample.lower_clipped
            output = self.controller.step(k, self.plan, sample.upper, sample.lower, None, *clipped)
            known = self._known(output.voltage)
            self._voltages.append(known)
            if self.supervisor is not None:
                ask(self.controller, self.supervisor.step(k, self.plan, sample.upper, known))
            identification = self.identifier.step(
                k, phase, sample.upper, self._voltages[0], clipped=sample.upper_clipped
            )
            truth = self.plant.advance(output.voltage)
            yield LoopStep(k, phase, sample, identification, output, truth)


def simulate(scenario: Scenario, progress: Progress | None = None) -> Recording:
    """Run one scenario in this process and record everything.

    Args:
        scenario: what to run.
        progress: called with every sample's `LoopStep`.
    """
    return _recorded(ClosedLoop(scenario), progress)[0]


def simulate_batch(
    scenarios: Sequence[Scenario],
    progress: Progress | None = None,
    truth: bool = True,
    keep: Collection[str] | None = None,
) -> list[Recording]:
    """Run scenarios as one batch; every recording equals that of `simulate`, bit for bit.

    The truth's fine samples are most of the memory: about 2 MB per trial and second at 4 kHz and three struts without
    compression. With `truth` false they are left out. `keep` names the groups, as in 'acceleration', or the fields,
    as in 'truth.stroke', that are recorded; None: all of them.

    Raises:
        SatvibError: scenarios that cannot run as one batch.
    """
    return _recorded(ClosedLoop(scenarios), progress, truth, keep)


def simulate_open_loop(recording: Recording) -> Recording:
    """Run the plant of a recording once more with every voltage zero: its open-loop twin, on the same seed.

    Only as many samples as were recorded; there is nothing of identifier and controller in it.
    """
    scenario, rig = recording.scenario, recording.rig
    if scenario is None or rig is None:
        raise SatvibError(f'{recording.source}: does not say which scenario and rig it is of')
    plant = make_failing_plant(rig, scenario.make_disturbance(), recording.seed, scenario.failures)
    end = int(recording.sequence[-1]) + 1
    samples = np.zeros((2, end, plant.struts))
    truths = np.zeros((2, end, plant.struts, plant.n_fine))
    strokes = np.zeros((end, plant.struts))
    silence = np.zeros(plant.struts)
    for k in range(end):
        sample = plant.sample()
        samples[:, k] = sample.upper, sample.lower
        truth = plant.advance(silence)
        truths[:, k] = truth.upper, truth.lower
        strokes[k] = truth.stroke
    first = int(recording.sequence[0])
    present = np.ones((end - first, plant.struts), dtype=bool)
    pairs = {'acceleration': samples[:, first:], 'truth': truths[:, first:]}
    groups: dict[str, Group] = {
        group: {'upper': upper, 'lower': lower, 'present': present}
        for group, (upper, lower) in pairs.items()
    }
    groups['truth']['stroke'] = strokes[first:]
    return replace(
        recording,
        groups=groups,
        source=f'open-loop twin of {scenario.name}',
        counts={},
    )


def _recorded(
    loop: ClosedLoop,
    progress: Progress | None,
    truth: bool = True,
    keep: Collection[str] | None = None,
) -> list[Recording]:
    recorder = StepRecorder(loop.plan, loop.shape, loop.plant.dt, truth, keep)
    for step in loop.steps():
        recorder.add(step)
        if progress is not None:
            progress(step)
    return recorder.recordings(loop.scenarios, loop.rigs)
