# SPDX-FileCopyrightText: 2026 The satvib authors
# SPDX-License-Identifier: Apache-2.0
"""Which nodes of a graph are there, and whether they have found each other.

A reader and a writer that are both in the graph have not yet found each other: on a busy machine that takes a second
more. In real time the first samples would be lost, and what is not sent while nobody reads it would be lost in lockstep
too. So every node must first report on /diagnostics that it has found the others; it does so as soon as it has.
"""

from collections import Counter

from diagnostic_msgs.msg import DiagnosticArray, DiagnosticStatus
from rclpy.node import Node
from rclpy.publisher import Publisher
from satvib_common.ros.diagnostics import READERS_OF, WRITERS_OF
from satvib_common.ros.qos import wanted

from satvib_bringup.live.graph import Graph

# of /diagnostics: a node reports again when it finds a new reader
REPORTS = wanted(whole=False, depth=100)
_OURS = frozenset({
    'plant_sim', 'strut_controller', 'centralized_controller', 'strut_identifier', 'recorder',
    'daq_bridge', 'supervisor',
})  # fmt: skip


class Discovery:
    """Which nodes are there, seen from the node that publishes the schedule.

    Args:
        graph: the nodes that are wanted.
        node: looks.
        schedule_out: its publisher of the schedule.

    The graph is in the namespace of the node that looks; names are shown without it.
    """

    def __init__(self, graph: Graph, node: Node, schedule_out: Publisher) -> None:
        self.graph = graph
        self._node = node
        self._schedule_out = schedule_out
        self._above = node.get_namespace().rstrip('/')
        self._reported: dict[str, dict[str, int]] = {}

    def on_diagnostics(self, message: DiagnosticArray) -> None:
        """Take what nodes report on /diagnostics about their own readers and writers."""
        for status in message.status:
            if status.level != DiagnosticStatus.STALE:
                self._reported[self._inside(status.name)] = {
                    pair.key.replace(f'{self._above}/', '/', 1): int(pair.value)
                    for pair in status.values
                    if pair.key.startswith((READERS_OF, WRITERS_OF))
                }

    def nodes(self) -> Counter[str]:
        """Satvib nodes that are in this domain, by full name without the leading slash."""
        return Counter(
            self._inside(f'{namespace.rstrip("/")}/{name}')
            for name, namespace in self._node.get_node_names_and_namespaces()
            if name in _OURS
        )

    def _inside(self, full_name: str) -> str:
        """A name without the namespace of the graph and the leading slash."""
        return full_name.removeprefix(f'{self._above}/').lstrip('/')

    def foreign_nodes(self) -> list[str]:
        """Satvib nodes that do not belong to this graph, or are there twice."""
        own = Counter(node.full_name for node in self.graph.nodes)
        return sorted((self.nodes() - own).elements())

    def missing(self) -> list[str]:
        """What is missing: nodes; then topics without writer or readers; then connections."""
        nodes = self.nodes()
        if absent := [n.full_name for n in self.graph.nodes if not nodes[n.full_name]]:
            return absent
        node = self._node
        incomplete = [
            topic
            for topic, readers in self.graph.readers().items()
            if node.count_publishers(self._above + topic) < 1
            or node.count_subscribers(self._above + topic) < readers
        ]
        return incomplete or self._unconnected()

    def _unconnected(self) -> list[str]:
        """Nodes that have not yet reported all their connections, with the first one that is missing."""
        needed = {}
        for topic, readers in self.graph.readers().items():
            needed[READERS_OF + topic], needed[WRITERS_OF + topic] = readers, 1
        found = []
        for spec in self.graph.nodes:
            reported = self._reported.get(spec.full_name)
            lacking = (
                [key for key, count in reported.items() if count < needed.get(key, 0)]
                if reported
                else ['diagnostics']
            )
            if lacking:
                found.append(f'{spec.full_name} without {lacking[0]}')
        readers = self._schedule_out.get_subscription_count()
        return found or ([] if readers >= self.graph.readers()['/schedule'] else ['/schedule'])
