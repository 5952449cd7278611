# SPDX-FileCopyrightText: 2026 The satvib authors
# SPDX-License-Identifier: Apache-2.0
"""Hears running graphs, whoever started them: finds struts by their topics, in any namespace.

A run begins when the readers of its topics are there, and a page is none of them. So the samples of a strut are heard
once its run is on: its controller reports how far it is, or its accelerations have been there for a while.
"""

import contextlib
import time
from collections.abc import Iterator

import rclpy
from diagnostic_msgs.msg import DiagnosticArray
from rcl_interfaces.msg import ParameterEvent
from rclpy.context import Context
from rclpy.qos import qos_profile_parameter_events
from rclpy.subscription import Subscription
from satvib_common.ros.diagnostics import READERS_OF, WRITERS_OF
from satvib_common.ros.host import make_executor
from satvib_common.ros.loop.rivals import UNKNOWN, node_of
from satvib_common.ros.loop.turns import Turns
from satvib_common.ros.main import lone_node
from satvib_common.ros.qos import wanted

from satvib_bringup.live.security.enclaves import TOOLS, enclave_arguments
from satvib_bringup.watch.graph import WatchedGraph
from satvib_bringup.watch.live.strut_topics import StrutTopics
from satvib_msgs.msg import Schedule

ACCELERATION, SCHEDULE = 'satvib_msgs/msg/StrutAcceleration', 'satvib_msgs/msg/Schedule'
WRITTEN = ('acceleration', 'voltage', 'identified_model')
_PATIENCE = 5.0  # s


class GraphListener:
    """A node in a context of its own, in the thread of its caller.

    Args:
        graph: takes what is heard.

    Attributes:
        changed: nodes whose parameters have changed; who shows them empties it.
    """

    def __init__(self, graph: WatchedGraph) -> None:
        self.graph = graph
        self.changed: set[str] = set()
        self._context = Context()
        self.node = lone_node('watch', self._context, enclave_arguments(TOOLS))
        self._heard = 0  # messages that are of no strut
        self._struts: dict[str, StrutTopics] = {}
        self._executor = make_executor(self._context)
        self._turns = Turns(self._executor, self._handled)
        self._executor.add_node(self.node)
        self._seen: dict[str, float] = {}
        self._schedules: dict[str, Subscription] = {}
        self.node.create_subscription(
            DiagnosticArray, '/diagnostics', self._on_diagnostics, wanted(whole=False, depth=100)
        )
        self.node.create_subscription(
            ParameterEvent, '/parameter_events', self._on_parameters, qos_profile_parameter_events
        )

    def work(self) -> None:
        """Take what has come; never waits."""
        self._turns.take(0.0)

    def collect(self) -> None:
        """Hand over what has come since the last call."""
        for strut in self._struts.values():
            strut.collect()
        if any(s.has_progress and not s.hears_samples for s in self._struts.values()):
            self.look()

    def look(self) -> None:
        """Find struts and the nodes that serve them; once a second, and when a run has begun."""
        now = time.monotonic()
        topics = self.node.get_topic_names_and_types()
        for topic, kinds in topics:
            name, _, last = topic.strip('/').rpartition('/')
            if ACCELERATION in kinds and last == 'acceleration' and name:
                self._look_at(name, now)
        for topic, kinds in topics:
            if SCHEDULE in kinds:
                self._look_at_schedule(topic)

    def close(self) -> None:
        """Leave the graph."""
        self._turns.close()
        with contextlib.suppress(Exception):
            self._executor.shutdown(0.0)
            self.node.destroy_node()
        rclpy.try_shutdown(context=self._context)

    def _handled(self) -> int:
        return self._heard + sum(strut.heard for strut in self._struts.values())

    def _look_at(self, name: str, now: float) -> None:
        topics = self._struts.get(name)
        if topics is None:
            topics = self._struts[name] = StrutTopics(self.node, self.graph.strut(name))
        nodes = {what: sorted(self._writers(f'/{name}/{what}')) for what in WRITTEN}
        self.graph.strut(name).nodes = nodes
        if not nodes['acceleration']:
            self._seen.pop(name, None)
            topics.rest()
            return
        since = self._seen.setdefault(name, now)
        if not topics.hears_samples and (topics.has_progress or now - since > _PATIENCE):
            topics.hear_samples()

    def _writers(self, topic: str) -> Iterator[str]:
        for info in self.node.get_publishers_info_by_topic(topic):
            if info.node_name != UNKNOWN:
                yield node_of(info)

    def _runs_on(self, topic: str) -> bool:
        """Whether the struts of a schedule are heard, which means that its run has begun."""
        above = topic.strip('/').rpartition('/')[0]
        return any(
            topics.hears_samples and name.rpartition('/')[0] == above
            for name, topics in self._struts.items()
        )

    def _look_at_schedule(self, topic: str) -> None:
        def take(message: Schedule) -> None:
            self._heard += 1
            self.graph.take_schedule(topic, message.scenario)

        heard = self._schedules.get(topic)
        if self._runs_on(topic) and heard is None:
            qos = wanted(whole=True, depth=1)
            self._schedules[topic] = self.node.create_subscription(Schedule, topic, take, qos)
        elif heard is not None and not self._runs_on(topic):
            self.node.destroy_subscription(self._schedules.pop(topic))

    def _on_diagnostics(self, message: DiagnosticArray) -> None:
        self._heard += 1
        for status in message.status:
            figures = {
                pair.key: pair.value
                for pair in status.values
                if not pair.key.startswith((READERS_OF, WRITERS_OF))
            }
            level = int.from_bytes(status.level, 'little')
            self.graph.take_status(status.name, level, status.message, figures)

    def _on_parameters(self, event: ParameterEvent) -> None:
        self._heard += 1
        if event.changed_parameters:
            self.changed.add(event.node)
