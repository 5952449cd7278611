# SPDX-FileCopyrightText: 2026 The satvib authors
# SPDX-License-Identifier: Apache-2.0
"""Is everyone of a graph there, and has everyone found everyone?

That a reader and a writer are both in the graph does not mean that they have found each other: on a busy machine that
takes a second more. In lockstep nobody misses anything by it; in real time the first samples would be lost, so there
every node must have said on /diagnostics that it has found the others.
"""

from collections import Counter

from diagnostic_msgs.msg import DiagnosticArray, DiagnosticStatus
from rclpy.node import Node
from rclpy.publisher import Publisher
from satvib_common.ros.diagnostics import READERS_OF, WRITERS_OF
from satvib_common.ros.qos import wanted

from satvib_bringup.live.graph import Graph

# of /diagnostics: what was said before counts too
SAID = wanted(whole=True, depth=100)
_OURS = frozenset({
    'plant_sim', 'strut_controller', 'centralized_controller', 'strut_identifier', 'recorder',
    'daq_bridge',
})  # fmt: skip


class Company:
    """Who is there, seen from a node that sets the graph going.

    Args:
        graph: what is to be there.
        node: looks.
        schedule_out: with what it will set the graph going.
    """

    def __init__(self, graph: Graph, node: Node, schedule_out: Publisher) -> None:
        self.graph = graph
        self._node = node
        self._schedule_out = schedule_out
        self._said: dict[str, dict[str, int]] = {}

    def hear(self, message: DiagnosticArray) -> None:
        """Take what nodes say on /diagnostics of their own readers and writers."""
        for status in message.status:
            if status.level != DiagnosticStatus.STALE:
                self._said[status.name.lstrip('/')] = {
                    pair.key: int(pair.value)
                    for pair in status.values
                    if pair.key.startswith((READERS_OF, WRITERS_OF))
                }

    def nodes(self) -> Counter[str]:
        """Satvib nodes that are in this domain, by full name without the leading slash."""
        return Counter(
            f'{namespace}/{name}'.lstrip('/')
            for name, namespace in self._node.get_node_names_and_namespaces()
            if name in _OURS
        )

    def strangers(self) -> list[str]:
        """Satvib nodes that are not of this graph, or there twice."""
        own = Counter(process.full_name for process in self.graph.processes)
        return sorted((self.nodes() - own).elements())

    def missing(self) -> list[str]:
        """What is not there yet: nodes; then topics without writer or readers; then, in real time, who lacks whom."""
        nodes = self.nodes()
        if absent := [p.full_name for p in self.graph.processes if not nodes[p.full_name]]:
            return absent
        node = self._node
        lonely = [
            topic
            for topic, readers in self.graph.readers().items()
            if node.count_publishers(topic) < 1 or node.count_subscribers(topic) < readers
        ]
        return lonely if lonely or not self.graph.realtime else self._alone()

    def _alone(self) -> list[str]:
        """Nodes that have not said yet that they have found everyone, with what they lack."""
        needed = {}
        for topic, readers in self.graph.readers().items():
            needed[READERS_OF + topic], needed[WRITERS_OF + topic] = readers, 1
        found = []
        for process in self.graph.processes:
            said = self._said.get(process.full_name)
            lacking = (
                [key for key, count in said.items() if count < needed.get(key, 0)]
                if said
                else ['diagnostics']
            )
            if lacking:
                found.append(f'{process.full_name} without {lacking[0]}')
        heard = self._schedule_out.get_subscription_count()
        return found or ([] if heard >= self.graph.readers()['/schedule'] else ['/schedule'])
