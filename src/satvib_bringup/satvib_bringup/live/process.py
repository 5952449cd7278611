# SPDX-FileCopyrightText: 2026 The satvib authors
# SPDX-License-Identifier: Apache-2.0
"""Nodes of a graph as plain data, and which of them share a process.

| composition | processes |
|---|---|
| separate | one for each node |
| strut | controller and identifier of a strut share one, as on a module of the rig; plant and recorder have their own |
| single | all nodes run in the process of the runner |

Whatever shares a process, a node reads the topics of its own strut only.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from enum import IntEnum
from pathlib import Path
from typing import Any

import yaml
from satvib_common.errors import SatvibError
from satvib_experiment.recording.topics import STRUT_TOPICS

COMPOSITIONS = ('separate', 'strut', 'single')

# by executable: topics of its struts that a node reads and writes
_TOPICS: dict[str, tuple[tuple[str, ...], tuple[str, ...]]] = {
    'plant_sim': (('voltage',), ('acceleration', 'truth')),
    'daq_bridge': (('voltage',), ('acceleration',)),
    'strut_controller': (('acceleration', 'identified_model'), ('voltage', 'controller_state')),
    'centralized_controller': (('acceleration',), ('voltage', 'controller_state')),
    'strut_identifier': (('acceleration', 'voltage'), ('identified_model',)),
    'supervisor': (('acceleration', 'voltage'), ()),
    'recorder': (tuple(STRUT_TOPICS), ()),
}


class Stage(IntEnum):
    """In which order processes stop: writers before readers."""

    SOURCE = 0
    CONTROLLER = 1
    IDENTIFIER = 2
    RECORDER = 3


class _Named:
    """What has a namespace and a name."""

    namespace: str
    name: str

    @property
    def full_name(self) -> str:
        """Namespace and name, as shown to people: strut_1/strut_controller."""
        return f'{self.namespace}/{self.name}'.lstrip('/')


@dataclass(frozen=True)
class NodeSpec(_Named):
    """One node.

    Attributes:
        package, executable: what is started when it is alone in a process.
        namespace: absolute; a strut's nodes live in the strut's.
        name: of the node.
        parameters: plain values.
        stage: when it stops.
        struts: whose topics it reads and writes.
    """

    package: str
    executable: str
    namespace: str
    name: str
    parameters: Mapping[str, Any]
    stage: Stage
    struts: tuple[str, ...]

    @property
    def reads(self) -> frozenset[str]:
        """Topics of the loop that it reads, absolute."""
        found = frozenset({'/schedule', *self._absolute(_TOPICS[self.executable][0])})
        waits = self.parameters.get('supervised') and self.parameters['lockstep']
        return found | {'/supervision'} if waits else found

    @property
    def writes(self) -> frozenset[str]:
        """Topics of the loop that it writes, absolute."""
        found = frozenset(self._absolute(_TOPICS[self.executable][1]))
        return found | {'/supervision'} if self.executable == 'supervisor' else found

    def _absolute(self, topics: Sequence[str]) -> list[str]:
        return [f'/{strut}/{topic}' for strut in self.struts for topic in topics]


@dataclass(frozen=True)
class Process(_Named):
    """One process.

    Attributes:
        package, executable: what is started.
        namespace: of its nodes.
        name: of the process; that of its node where there is one.
        nodes: that run in it.
    """

    package: str
    executable: str
    namespace: str
    name: str
    nodes: tuple[NodeSpec, ...]

    @property
    def stage(self) -> Stage:
        """When it stops."""
        return max(node.stage for node in self.nodes)

    @property
    def has_controller(self) -> bool:
        """Whether voltages end with this process."""
        return any(node.stage == Stage.CONTROLLER for node in self.nodes)

    def parameter_file(self) -> str:
        """Text of a ROS parameter file with the parameters of its nodes."""
        alone = len(self.nodes) == 1
        sections = {
            '/**' if alone else f'/{node.full_name}': {'ros__parameters': dict(node.parameters)}
            for node in self.nodes
        }
        return yaml.safe_dump(sections, sort_keys=False)

    def arguments(self, parameter_file: Path) -> list[str]:
        """Arguments of the executable."""
        name = ['-r', f'__node:={self.name}'] if len(self.nodes) == 1 else []
        return [
            '--ros-args',
            '-r', f'__ns:={self.namespace}',
            *name,
            '--params-file', str(parameter_file),
        ]  # fmt: skip


def check_composition(composition: str) -> str:
    """Give back the name of a composition.

    Raises:
        SatvibError: there is none of that name.
    """
    if composition not in COMPOSITIONS:
        known = ', '.join(COMPOSITIONS)
        raise SatvibError(f'composition: {composition!r} is not one of {known}')
    return composition


def processes_of(nodes: Sequence[NodeSpec], composition: str) -> tuple[Process, ...]:
    """Put nodes into processes, in the order of the first node of each."""
    if composition == 'single':
        return ()
    groups: dict[str, list[NodeSpec]] = {}
    for node in nodes:
        together = composition == 'strut' and node.namespace != '/'
        groups.setdefault(node.namespace if together else node.full_name, []).append(node)
    return tuple(_process(group) for group in groups.values())


def _process(group: Sequence[NodeSpec]) -> Process:
    first = group[0]
    if len(group) == 1:
        kind = (first.package, first.executable, first.namespace, first.name)
    else:
        kind = ('satvib_bringup', 'strut', first.namespace, 'strut')
    return Process(*kind, tuple(group))
