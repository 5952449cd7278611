# SPDX-FileCopyrightText: 2026 The satvib authors
# SPDX-License-Identifier: Apache-2.0
"""The live graph of a scenario, from the same description as `satvib run`.

    ros2 launch satvib_bringup simulation.launch.py scenario:=paper_3dof bag:=/tmp/bag

The nodes start, find each other, and the node `schedule` sets them going. When the plant has ended, so does the launch.
"""

from pathlib import Path

from launch import LaunchContext, LaunchDescription
from launch.actions import (
    DeclareLaunchArgument,
    EmitEvent,
    OpaqueFunction,
    RegisterEventHandler,
    SetEnvironmentVariable,
)
from launch.event_handlers import OnProcessExit
from launch.events import Shutdown
from launch.substitutions import LaunchConfiguration
from launch_ros.actions import Node
from satvib_bringup.live.graph import graph_of
from satvib_bringup.live.process import Process, Stage
from satvib_bringup.live.workspace import graph_environment
from satvib_experiment.scenario.scenario import load_scenario

ARGUMENTS = {
    'scenario': ('paper_3dof', 'name of a scenario, or path of its YAML file'),
    'overrides': ('', "changes, separated by spaces: 'seed=7 controller.law=velocity_feedback'"),
    'realtime': ('false', 'true: at the pace of the clock instead of in lockstep'),
    'composition': ('', 'separate, strut or single; empty: as the scenario says'),
    'bag': ('', 'folder of the bag to be recorded; empty: none'),
}


def generate_launch_description() -> LaunchDescription:
    declared = [
        DeclareLaunchArgument(name, default_value=default, description=description)
        for name, (default, description) in ARGUMENTS.items()
    ]
    return LaunchDescription([*declared, OpaqueFunction(function=start_graph)])


def start_graph(context: LaunchContext) -> list[object]:
    value = {name: LaunchConfiguration(name).perform(context) for name in ARGUMENTS}
    overrides = value['overrides'].split()
    bag = Path(value['bag']) if value['bag'] else None
    realtime = value['realtime'].lower() == 'true'
    composition = value['composition']
    graph = graph_of(load_scenario(value['scenario'], overrides), realtime, bag, composition)
    profiles = 'FASTRTPS_DEFAULT_PROFILES_FILE'
    actions: list[object] = [SetEnvironmentVariable(profiles, graph_environment()[profiles])]
    if not graph.processes:
        single = [value['scenario'], *(f'--set={change}' for change in overrides)]
        single += ['--realtime'] if realtime else []
        single += [f'--bag={bag}'] if bag else []
        return [
            *actions,
            Node(package='satvib_bringup', executable='single', arguments=single, output='screen'),
        ]
    for process in graph.processes:
        node = started(process)
        actions.append(node)
        if process.stage == Stage.SOURCE:
            over = EmitEvent(event=Shutdown(reason='the plant has ended'))
            actions.append(RegisterEventHandler(OnProcessExit(target_action=node, on_exit=[over])))
    scenario = {'scenario': value['scenario'], 'realtime': realtime, 'recorded': bag is not None}
    scenario |= {'overrides': overrides} if overrides else {}
    scenario |= {'composition': composition} if composition else {}
    actions.append(
        Node(
            package='satvib_bringup', executable='schedule', name='schedule', parameters=[scenario]
        )
    )
    return actions


def started(process: Process) -> Node:
    """What launch starts; the nodes of a shared process keep their names."""
    name = {'name': process.name} if len(process.nodes) == 1 else {}
    return Node(
        package=process.package,
        executable=process.executable,
        namespace=process.namespace,
        parameters=[parameter_file(process.parameter_file())],
        output='screen',
        **name,
    )


def parameter_file(text: str) -> str:
    """Write a parameter file; launch's own translation would lose the types of empty lists."""
    import tempfile

    with tempfile.NamedTemporaryFile('w', suffix='.yaml', delete=False) as sink:
        sink.write(text)
    return sink.name
