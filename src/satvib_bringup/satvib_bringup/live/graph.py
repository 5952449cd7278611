# SPDX-FileCopyrightText: 2026 The satvib authors
# SPDX-License-Identifier: Apache-2.0
"""Which processes make up the live graph of a scenario, and with which parameters.

One description for the runner and for the launch file:

    plant_sim                  source of the samples
    strut_i/strut_controller   answers them
    strut_i/strut_identifier   reads both
    recorder                   records all topics

In the centralized scheme one `centralized_controller` stands in the place of all strut controllers.

Nothing here knows ROS: a description is plain data.
"""

from __future__ import annotations

import json
from collections.abc import Mapping
from dataclasses import dataclass
from enum import IntEnum
from pathlib import Path
from typing import Any

import yaml
from satvib_common.errors import SatvibError
from satvib_common.phases import Phase, PhasePlan
from satvib_common.settings_text import setting_text
from satvib_common.struts.names import strut_names
from satvib_experiment.analysis.tones import disturbance_onset
from satvib_experiment.recording.bag_reader import custom_data
from satvib_experiment.recording.topics import STRUT_TOPICS
from satvib_experiment.scenario.scenario import Scenario
from satvib_plant_sim.nodes.parameters import PlantParameters
from satvib_plant_sim.plant.failures import CONTROLLER
from satvib_plant_sim.rig.any_rig import strut_count

from satvib_bringup.recorder.check import REPORT, expected_models

CENTRALIZED = 'centralized_controller'


class Stage(IntEnum):
    """In which order processes stop: writers before readers."""

    SOURCE = 0
    CONTROLLER = 1
    IDENTIFIER = 2
    RECORDER = 3


@dataclass(frozen=True)
class Process:
    """One process with one node.

    Attributes:
        package, executable: what is started.
        namespace: absolute; a strut's nodes live in the strut's.
        name: of the node.
        parameters: plain values.
        stage: when it stops.
    """

    package: str
    executable: str
    namespace: str
    name: str
    parameters: Mapping[str, Any]
    stage: Stage

    @property
    def full_name(self) -> str:
        """Namespace and name, as shown to people: strut_1/strut_controller."""
        return f'{self.namespace}/{self.name}'.lstrip('/')

    def parameter_file(self) -> str:
        """Text of a ROS parameter file with these parameters."""
        return yaml.safe_dump({'/**': {'ros__parameters': dict(self.parameters)}}, sort_keys=False)

    def arguments(self, parameter_file: Path) -> list[str]:
        """Arguments of the executable."""
        return [
            '--ros-args',
            '-r', f'__ns:={self.namespace}',
            '-r', f'__node:={self.name}',
            '--params-file', str(parameter_file),
        ]  # fmt: skip


@dataclass(frozen=True)
class Graph:
    """The whole graph and the schedule that starts it.

    Attributes:
        processes: in the order in which they start.
        scenario: its name.
        seed: of everything random.
        sample_period: s.
        struts: names.
        plan: phases by sample.
        models: how many models a strut publishes.
        custom: texts for the bag: the scenario and the rig.
        kills: sample and full name of each controller that is to be killed.
        realtime: samples follow the clock; otherwise lockstep.
        onset: s, when the disturbance begins.
    """

    processes: tuple[Process, ...]
    scenario: str
    seed: int
    sample_period: float
    struts: tuple[str, ...]
    plan: PhasePlan
    models: int
    custom: Mapping[str, str]
    kills: tuple[tuple[int, str], ...] = ()
    realtime: bool = False
    onset: float = 0.0

    def silenced(self) -> frozenset[str]:
        """Names of the struts whose controllers are killed in the run."""
        named = {name.rpartition('/')[0] for _, name in self.kills}
        return frozenset(self.struts if '' in named else named)

    def topics(self) -> list[str]:
        """Topics of the struts, absolute."""
        return [f'/{strut}/{topic}' for strut in self.struts for topic in STRUT_TOPICS]

    def readers(self) -> dict[str, int]:
        """How many of the graph's own nodes read each topic of the loop, when all are there."""
        recorder = sum(p.stage == Stage.RECORDER for p in self.processes)
        controllers = sum(p.stage == Stage.CONTROLLER for p in self.processes)
        found = {'/schedule': 1 + len(self.struts) + controllers + recorder}
        alone = any(p.executable == CENTRALIZED for p in self.processes)
        own = {'acceleration': 2, 'voltage': 2, 'identified_model': 0 if alone else 1}
        for strut in self.struts:
            for topic in STRUT_TOPICS:
                found[f'/{strut}/{topic}'] = own.get(topic, 0) + recorder
        return found


def graph_of(scenario: Scenario, realtime: bool = False, bag: Path | None = None) -> Graph:
    """Describe the graph of a scenario.

    Args:
        scenario: checked.
        realtime: samples follow the clock; otherwise lockstep.
        bag: folder of the bag to be written; None: nothing is recorded.

    Raises:
        SatvibError: parameters that do not fit.
    """
    rig = scenario.load_rig()
    rate = rig.acquisition.sample_rate
    struts = strut_names(strut_count(rig))
    plant = PlantParameters(
        rig=scenario.rig,
        rig_overrides=tuple(setting_text(k, v) for k, v in scenario.rig_overrides.items()),
        disturbance=_inline(scenario.disturbance or {'kind': 'none'}),
        failures=_inline([f.to_mapping() for f in scenario.failures if f.kind != CONTROLLER]),
        seed=scenario.seed,
        lockstep=not realtime,
        command_timeout=scenario.command_timeout,
    )
    identifier = scenario.identifier_parameters(rate, not realtime)
    controller = scenario.controller_parameters(rate, not realtime)
    plan = scenario.plan(rate)
    phases = frozenset(Phase[name] for name in identifier.estimate_in)
    custom = custom_data(scenario, rig, realtime)
    processes = []
    if bag is not None:
        recorder = {
            'folder': str(bag),
            'struts': list(struts),
            'report': str(bag.with_name(REPORT)),
            'custom_keys': list(custom),
            'custom_values': list(custom.values()),
        }
        processes.append(
            Process('satvib_bringup', 'recorder', '/', 'recorder', recorder, Stage.RECORDER)
        )
    central = scenario.scheme == 'centralized'
    if central:
        processes.append(
            Process(
                'satvib_control', CENTRALIZED, '/', CENTRALIZED,
                controller.to_mapping(), Stage.CONTROLLER,
            )
        )  # fmt: skip
    for i, strut in enumerate(struts):
        if not central:
            processes.append(
                Process(
                    'satvib_control', 'strut_controller', f'/{strut}', 'strut_controller',
                    controller.replace(strut=i).to_mapping(), Stage.CONTROLLER,
                )
            )  # fmt: skip
        processes.append(
            Process(
                'satvib_ident', 'strut_identifier', f'/{strut}', 'strut_identifier',
                identifier.to_mapping(), Stage.IDENTIFIER,
            )
        )  # fmt: skip
    processes.append(
        Process('satvib_plant_sim', 'plant_sim', '/', 'plant_sim', plant.to_mapping(), Stage.SOURCE)
    )
    return Graph(
        processes=tuple(processes),
        scenario=scenario.name,
        seed=scenario.seed,
        sample_period=1.0 / rate,
        struts=struts,
        plan=plan,
        models=expected_models(plan, phases, identifier.model_period),
        custom=custom,
        kills=_kills(scenario, processes, rate, realtime),
        realtime=realtime,
        onset=disturbance_onset(scenario.make_disturbance()),
    )


def _inline(value: Any) -> str:
    """YAML in one line."""
    return json.dumps(value)


def _kills(
    scenario: Scenario, processes: list[Process], rate: float, realtime: bool
) -> tuple[tuple[int, str], ...]:
    """Which processes are to be killed at which samples.

    Raises:
        SatvibError: a controller is to be killed in lockstep, where the plant would wait for it for ever.
    """
    found = []
    for failure in scenario.failures:
        if failure.kind != CONTROLLER:
            continue
        if not realtime:
            raise SatvibError(
                f'scenario {scenario.name}: failures: in lockstep the plant waits for every '
                'controller, one that is killed ends the run; run it with --realtime, or simulate it'
            )
        for process in processes:
            alone = process.executable == CENTRALIZED or failure.strut == 0
            if process.stage == Stage.CONTROLLER and (
                alone or process.namespace == f'/strut_{failure.strut}'
            ):
                found.append((failure.sample(1.0 / rate), process.full_name))
    return tuple(sorted(found))
