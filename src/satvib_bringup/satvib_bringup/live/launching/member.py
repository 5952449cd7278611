# SPDX-FileCopyrightText: 2026 The satvib authors
# SPDX-License-Identifier: Apache-2.0
"""One process of a launch as plain data: its executable, its parameters as arguments, and its part in the end.

Parameters are arguments (`-p name:=value`) and not files, so that a launch leaves no temporary file.
"""

import json
from collections.abc import Mapping
from dataclasses import dataclass, replace
from typing import Any

from satvib_bringup.live.process import NodeSpec, Process, Stage


@dataclass(frozen=True)
class Member:
    """One process of a launch.

    Attributes:
        package, executable: what is started.
        namespace: absolute.
        name: of its node; empty where the nodes of the process keep their names, or have none.
        ros_arguments: what follows `--ros-args`.
        arguments: what stands before.
        stage: when it is stopped, after a member with `ends` has ended well.
        ends: its good end ends the launch.
    """

    package: str
    executable: str
    namespace: str = '/'
    name: str = ''
    ros_arguments: tuple[str, ...] = ()
    arguments: tuple[str, ...] = ()
    stage: Stage = Stage.SOURCE
    ends: bool = False

    @property
    def full_name(self) -> str:
        """Namespace and name, as shown to people: strut_1/strut_controller."""
        return f'{self.namespace}/{self.name or self.executable}'.lstrip('/')

    def below(self, namespace: str) -> 'Member':
        """The same in a namespace; empty or /: as it is."""
        parts = [part for part in f'{namespace}/{self.namespace}'.split('/') if part]
        return replace(self, namespace=f'/{"/".join(parts)}')

    def with_ros_arguments(self, *more: str) -> 'Member':
        """The same with more of them, which win."""
        return replace(self, ros_arguments=(*self.ros_arguments, *more))


def member_of(process: Process) -> Member:
    """The member that runs a process of a graph."""
    alone = len(process.nodes) == 1
    given = [
        argument
        for node in process.nodes
        for argument in parameter_arguments(node.parameters, '' if alone else f'{node.name}:')
    ]
    return Member(
        process.package, process.executable, process.namespace, process.name if alone else '',
        tuple(given), stage=process.stage, ends=process.stage == Stage.SOURCE,
    )  # fmt: skip


def member_of_node(
    package: str, executable: str, parameters: Mapping[str, Any], **more: Any
) -> Member:
    """The member that runs one node under its own name."""
    given = tuple(parameter_arguments(parameters))
    return Member(package, executable, name=executable, ros_arguments=given, **more)


def of_strut(nodes: tuple[NodeSpec, ...], strut: str) -> tuple[NodeSpec, ...]:
    """The nodes in the namespace of a strut."""
    return tuple(node for node in nodes if node.namespace == f'/{strut}')


def parameter_arguments(parameters: Mapping[str, Any], prefix: str = '') -> list[str]:
    """Give `-p name:=value` for each parameter; JSON is the YAML that rcl reads, with every text in quotes."""
    found = []
    for name, value in parameters.items():
        found += ['-p', f'{prefix}{name}:={json.dumps(value)}']
    return found
