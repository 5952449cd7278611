# SPDX-FileCopyrightText: 2026 The satvib authors
# SPDX-License-Identifier: Apache-2.0
"""Which nodes make up the live graph of a scenario, with which parameters, and in which processes they run.

One description for the runner and for the launch file:

    plant_sim                  source of the samples
    strut_i/strut_controller   answers them
    strut_i/strut_identifier   reads both
    recorder                   records all topics
    supervisor                 where the scenario asks for one: listens to all struts

In the centralized scheme one `centralized_controller` stands in the place of all strut controllers. How nodes share
processes is in `process`.

Nothing here knows ROS: a description is plain data.
"""

from __future__ import annotations

import json
from collections.abc import Mapping
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

from satvib_common.errors import SatvibError
from satvib_common.phases import Phase, PhasePlan
from satvib_common.settings_text import setting_text
from satvib_common.struts.names import strut_names
from satvib_control.core.parameters import state_every
from satvib_experiment.analysis.tones import disturbance_onset
from satvib_experiment.recording.bag_reader import custom_data
from satvib_experiment.recording.topics import STRUT_TOPICS
from satvib_experiment.scenario.scenario import Scenario
from satvib_ident.model_times import ModelTimes
from satvib_plant_sim.nodes.parameters import PlantParameters
from satvib_plant_sim.plant.failures import CONTROLLER
from satvib_plant_sim.rig.any_rig import strut_count

from satvib_bringup.live.process import (
    NodeSpec,
    Process,
    Stage,
    check_composition,
    processes_of,
)
from satvib_bringup.recorder.check import REPORT, Expected

CENTRALIZED = 'centralized_controller'
SUPERVISOR = 'supervisor'
BRIDGE = 'daq_bridge'


@dataclass(frozen=True)
class Graph:
    """The whole graph and the schedule that starts it.

    Attributes:
        nodes: in the order in which they start.
        processes: that run them; none where they all share the process of the runner.
        scenario: its name.
        seed: of everything random.
        sample_period: s.
        struts: names.
        plan: phases by sample.
        expected: how many messages a strut publishes.
        custom: texts for the bag: the scenario and the rig.
        kills: sample and full name of each controller that is to be killed.
        realtime: samples follow the clock; otherwise lockstep.
        onset: s, when the disturbance begins.
    """

    nodes: tuple[NodeSpec, ...]
    processes: tuple[Process, ...]
    scenario: str
    seed: int
    sample_period: float
    struts: tuple[str, ...]
    plan: PhasePlan
    expected: Expected
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
        """How many processes read each topic of the loop over the middleware, when all are there."""
        found = dict.fromkeys(('/schedule', *self.topics()), 0)
        for process in self.processes:
            written = {topic for node in process.nodes for topic in node.writes}
            for topic in {topic for node in process.nodes for topic in node.reads} - written:
                found[topic] = found.get(topic, 0) + 1
        silent = set(self.topics()).difference(*(node.writes for node in self.nodes))
        return {topic: count for topic, count in found.items() if topic not in silent}


def graph_of(
    scenario: Scenario,
    realtime: bool = False,
    bag: Path | None = None,
    composition: str = '',
    arrivals: Path | None = None,
) -> Graph:
    """Describe the graph of a scenario.

    Args:
        scenario: checked.
        realtime: samples follow the clock; otherwise lockstep.
        bag: folder of the bag to be written; None: nothing is recorded.
        composition: which nodes share a process, see `process.COMPOSITIONS`; empty: as the scenario says.
        arrivals: file for the arrivals of the voltages in real time; None: none.

    Raises:
        SatvibError: parameters that do not fit.
    """
    composition = check_composition(composition or scenario.composition)
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
        arrival_file=str(arrivals or ''),
    )
    identifier = scenario.identifier_parameters(rate, not realtime)
    controller = scenario.controller_parameters(rate, not realtime)
    plan = scenario.plan(rate)
    phases = frozenset(Phase[name] for name in identifier.estimate_in)
    times = ModelTimes(plan, phases, identifier.model_period)
    custom = custom_data(scenario, rig, realtime)
    nodes: list[NodeSpec] = []
    if bag is not None:
        nodes.append(_recorder(bag, struts, custom, not realtime))
    central = scenario.scheme == 'centralized'
    if central:
        nodes.append(
            NodeSpec(
                'satvib_control', CENTRALIZED, '/', CENTRALIZED,
                controller.to_mapping(), Stage.CONTROLLER, struts,
            )
        )  # fmt: skip
    if scenario.supervisor:
        controller = controller.replace(supervised=True)
        listens = scenario.supervisor_parameters(rate, not realtime).to_mapping()
        nodes.append(
            NodeSpec(
                'satvib_control', SUPERVISOR, '/', SUPERVISOR, listens, Stage.IDENTIFIER, struts
            )
        )
    for i, strut in enumerate(struts):
        if not central:
            nodes.append(
                NodeSpec(
                    'satvib_control', 'strut_controller', f'/{strut}', 'strut_controller',
                    controller.replace(strut=i).to_mapping(), Stage.CONTROLLER, (strut,),
                )
            )  # fmt: skip
        nodes.append(
            NodeSpec(
                'satvib_ident', 'strut_identifier', f'/{strut}', 'strut_identifier',
                identifier.to_mapping(), Stage.IDENTIFIER, (strut,),
            )
        )  # fmt: skip
    nodes.append(
        NodeSpec(
            'satvib_plant_sim', 'plant_sim', '/', 'plant_sim', plant.to_mapping(), Stage.SOURCE,
            struts,
        )
    )  # fmt: skip
    processes = processes_of(nodes, composition)
    return Graph(
        nodes=tuple(nodes),
        processes=processes,
        scenario=scenario.name,
        seed=scenario.seed,
        sample_period=1.0 / rate,
        struts=struts,
        plan=plan,
        expected=Expected(
            samples=plan.end,
            models=times.count(),
            states=-(-plan.end // state_every(controller, controller.lockstep)),
            truths=-(-plan.end // max(round(plant.truth_period * rate), 1)),
        ),
        custom=custom,
        kills=_kills(scenario, processes, rate, realtime),
        realtime=realtime,
        onset=disturbance_onset(scenario.make_disturbance()),
    )


def with_bridge(graph: Graph, channels: str) -> Graph:
    """The same graph with `daq_bridge` in the place of the plant.

    Args:
        graph: in real time.
        channels: path of the channels file.
    """

    def real(node: NodeSpec) -> NodeSpec:
        if node.stage != Stage.SOURCE:
            return node
        given = {'channels': channels, 'sample_rate': 1.0 / graph.sample_period}
        return NodeSpec('satvib_daq_bridge', BRIDGE, '/', BRIDGE, given, Stage.SOURCE, node.struts)

    processes = tuple(
        process
        if process.stage != Stage.SOURCE
        else Process('satvib_daq_bridge', BRIDGE, '/', BRIDGE, tuple(map(real, process.nodes)))
        for process in graph.processes
    )
    return replace(graph, nodes=tuple(map(real, graph.nodes)), processes=processes)


def _recorder(
    bag: Path, struts: tuple[str, ...], custom: Mapping[str, str], lockstep: bool
) -> NodeSpec:
    parameters = {
        'folder': str(bag),
        'lockstep': lockstep,
        'struts': list(struts),
        'report': str(bag.with_name(REPORT)),
        'custom_keys': list(custom),
        'custom_values': list(custom.values()),
    }
    return NodeSpec(
        'satvib_bringup', 'recorder', '/', 'recorder', parameters, Stage.RECORDER, struts
    )


def _inline(value: Any) -> str:
    """YAML in one line."""
    return json.dumps(value)


def _kills(
    scenario: Scenario, processes: tuple[Process, ...], rate: float, realtime: bool
) -> tuple[tuple[int, str], ...]:
    """Which processes are to be killed at which samples.

    Raises:
        SatvibError: a controller is to be killed in lockstep, where the plant would wait for it for ever, or in the
            process of all others.
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
        if not processes:
            raise SatvibError(
                f'scenario {scenario.name}: failures: in composition single no controller has a '
                'process of its own that could be killed; use separate or strut'
            )
        for process in processes:
            alone = process.executable == CENTRALIZED or failure.strut == 0
            if process.has_controller and (alone or process.namespace == f'/strut_{failure.strut}'):
                found.append((failure.sample(1.0 / rate), process.full_name))
    return tuple(sorted(found))
