# SPDX-FileCopyrightText: 2026 The satvib authors
# SPDX-License-Identifier: Apache-2.0
"""The SROS2 policy of a graph: what each of its processes may publish, hear, offer and call, and nothing else.

Every process has an enclave with its name, so the controller of strut 1 can publish no voltage of strut 2. Names are
absolute. The form is that of `ros2 security generate_policy`, version 0.2.0 (https://design.ros2.org/articles/
ros2_access_control_policies.html); `ros2 security generate_artifacts` makes keys and signed permissions of it.
"""

from collections.abc import Iterable
from dataclasses import dataclass
from xml.etree import ElementTree as Xml

from satvib_bringup.live.graph import Graph
from satvib_bringup.live.process import NodeSpec
from satvib_bringup.live.security.enclaves import RUNNER, SCHEDULE, TOOLS

_VERSION = '0.2.0'
# of every node of satvib; `~` is the node itself
_OF_ANY_NODE = ('/rosout', '/parameter_events')
_PUBLISHES = (*_OF_ANY_NODE, '/diagnostics', '~/transition_event')
_PARAMETERS = (
    'describe_parameters', 'get_parameter_types', 'get_parameters', 'list_parameters', 'set_parameters',
    'set_parameters_atomically', 'get_type_description',
)  # fmt: skip
_LIFECYCLE = (
    'change_state', 'get_state', 'get_available_states', 'get_available_transitions',
    'get_transition_graph',
)  # fmt: skip
_CONTROLLER = ('hold', 'release')
# by executable, beyond what `NodeSpec` says: topics of its struts and shared topics that it publishes, those
# that it hears, and its services
_MORE: dict[str, tuple[tuple[str, ...], tuple[str, ...], tuple[str, ...]]] = {
    'plant_sim': (('voltage_applied', '/clock'), (), ()),
    'daq_bridge': (('voltage_applied',), (), ('arm', 'calibrate', 'estop')),
    'strut_controller': (('progress',), (), _CONTROLLER),
    'centralized_controller': (('progress',), (), _CONTROLLER),
    'strut_identifier': ((), ('controller_state',), ()),
    'recorder': ((), ('/diagnostics',), ()),
}


@dataclass(frozen=True)
class Rights:
    """What a node may do; all names are absolute.

    Attributes:
        namespace, name: of the node.
        publishes, subscribes: topics.
        replies, requests: services that it offers and calls.
    """

    namespace: str
    name: str
    publishes: frozenset[str] = frozenset()
    subscribes: frozenset[str] = frozenset()
    replies: frozenset[str] = frozenset()
    requests: frozenset[str] = frozenset()


def rights_of(graph: Graph) -> dict[str, list[Rights]]:
    """Give the rights of the nodes of each process, by the name of the process, with those of the runner and of tools.

    Args:
        graph: its processes; where all nodes share the process of the runner, they have the runner's enclave.
    """
    found = {p.full_name: [_rights(node, graph) for node in p.nodes] for p in graph.processes}
    shared = [] if graph.processes else [_rights(node, graph) for node in graph.nodes]
    return found | {RUNNER: [*_runner(graph), *shared], TOOLS: [_tools()]}


def policy_of(graph: Graph) -> str:
    """Give the policy of a graph as XML."""
    policy = Xml.Element('policy', version=_VERSION)
    enclaves = Xml.SubElement(policy, 'enclaves')
    for process, nodes in rights_of(graph).items():
        enclave = Xml.SubElement(enclaves, 'enclave', path=f'/{process}')
        profiles = Xml.SubElement(enclave, 'profiles')
        for node in nodes:
            profile = Xml.SubElement(profiles, 'profile', ns=node.namespace, node=node.name)
            _list(profile, 'topic', 'publish', node.publishes)
            _list(profile, 'topic', 'subscribe', node.subscribes)
            _list(profile, 'service', 'reply', node.replies)
            _list(profile, 'service', 'request', node.requests)
    Xml.indent(policy)
    return f'<?xml version="1.0" encoding="UTF-8"?>\n{Xml.tostring(policy, encoding="unicode")}\n'


def _list(profile: Xml.Element, what: str, right: str, names: Iterable[str]) -> None:
    """Add one list of names, unless it is empty."""
    if ordered := sorted(names):
        group = Xml.SubElement(profile, f'{what}s', {right: 'ALLOW'})
        for name in ordered:
            Xml.SubElement(group, what).text = name


def _rights(node: NodeSpec, graph: Graph) -> Rights:
    more_out, more_in, services = _MORE.get(node.executable, ((), (), ()))
    own = f'/{node.full_name}'
    asked = ('hold', 'release', 'stop') if node.executable == 'supervisor' else ()
    return Rights(
        node.namespace,
        node.name,
        node.writes | _absolute(more_out, node) | _own(_PUBLISHES, own),
        node.reads | _absolute(more_in, node),
        _own([f'~/{s}' for s in (*_PARAMETERS, *_LIFECYCLE, 'stop', 'reset', *services)], own),
        frozenset(f'/{strut}/strut_controller/{what}' for strut in graph.struts for what in asked),
    )


def _absolute(topics: Iterable[str], node: NodeSpec) -> frozenset[str]:
    """Shared topics as they are, the others for each strut of a node."""
    return frozenset(
        name
        for topic in topics
        for name in ([topic] if topic.startswith('/') else [f'/{s}/{topic}' for s in node.struts])
    )


def _own(names: Iterable[str], node: str) -> frozenset[str]:
    return frozenset(name.replace('~', node, 1) for name in names)


def _runner(graph: Graph) -> list[Rights]:
    """Who begins a run and follows it: the runner, and the node `schedule` in its place."""
    progress = frozenset(f'/{strut}/progress' for strut in graph.struts)
    services = [f'~/{s}' for s in (*_PARAMETERS, *_LIFECYCLE, 'stop', 'reset')]
    return [
        Rights(
            '/', RUNNER, frozenset({'/schedule', *_OF_ANY_NODE}), progress | {'/diagnostics'},
            frozenset({f'/{RUNNER}/get_type_description'}),
        ),
        Rights(
            '/', SCHEDULE, _own(('/schedule', *_PUBLISHES), f'/{SCHEDULE}'), frozenset({'/diagnostics'}),
            _own(services, f'/{SCHEDULE}'),
        ),
    ]  # fmt: skip


def _tools() -> Rights:
    """Hear everything and call every service; publish nothing of the loop."""
    said = frozenset(_OF_ANY_NODE)
    return Rights('/', TOOLS, said, frozenset({'/*'}), frozenset({'/*'}), frozenset({'/*'}))
