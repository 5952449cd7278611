# SPDX-FileCopyrightText: 2026 The satvib authors
# SPDX-License-Identifier: Apache-2.0
"""The runner's view of the live graph: which nodes are there, how far the run is, and the schedule that starts it.

How far the run is comes on topics that controllers publish some twenty times a second, whatever the rate of the loop.
"""

import contextlib
from functools import partial
from types import TracebackType
from typing import Self

import rclpy
from diagnostic_msgs.msg import DiagnosticArray
from rclpy.context import Context
from rclpy.executors import SingleThreadedExecutor
from rclpy.qos import DurabilityPolicy, HistoryPolicy, QoSProfile, ReliabilityPolicy
from satvib_common.ros.main import lone_node
from satvib_common.ros.qos import offered

from satvib_bringup.live.discovery import REPORTS, Discovery
from satvib_bringup.live.graph import Graph
from satvib_bringup.live.progress import Progress
from satvib_bringup.live.schedule_message import graph_schedule
from satvib_bringup.live.security.enclaves import RUNNER, enclave_arguments
from satvib_bringup.live.track import Track
from satvib_msgs.msg import Schedule, StrutProgress

_LATEST = QoSProfile(
    history=HistoryPolicy.KEEP_LAST,
    depth=1,
    reliability=ReliabilityPolicy.BEST_EFFORT,
    durability=DurabilityPolicy.VOLATILE,
)


class Observer:
    """A node in a context of its own, so that it can live in any process.

    Args:
        graph: what is to be observed.
    """

    def __init__(self, graph: Graph) -> None:
        self.graph = graph
        self._context = Context()
        self._node = lone_node(RUNNER, self._context, enclave_arguments(RUNNER))
        self._executor = SingleThreadedExecutor(context=self._context)
        self._executor.add_node(self._node)
        self._schedule_out = self._node.create_publisher(Schedule, '/schedule', offered(1))
        self._track = Track(graph)
        self.discovery = Discovery(graph, self._node, self._schedule_out)
        self._diagnostics = self._node.create_subscription(
            DiagnosticArray, '/diagnostics', self.discovery.on_diagnostics, REPORTS
        )
        for strut in graph.struts:
            self._node.create_subscription(
                StrutProgress,
                f'/{strut}/progress',
                partial(self._track.take, strut),
                _LATEST,
            )

    def __enter__(self) -> Self:
        """Nothing to do."""
        return self

    def __exit__(
        self,
        kind: type[BaseException] | None,
        error: BaseException | None,
        trace: TracebackType | None,
    ) -> None:
        """Leave the graph."""
        with contextlib.suppress(Exception):
            self._executor.shutdown(0.0)
            self._node.destroy_node()
        rclpy.try_shutdown(context=self._context)

    def missing(self) -> list[str]:
        """What is not there yet, after what nodes have reported meanwhile."""
        self._spin(2 * len(self.graph.nodes))
        return self.discovery.missing()

    def _spin(self, times: int) -> None:
        for _ in range(times):
            self._executor.spin_once(timeout_sec=0.0)

    def publish_schedule(self) -> None:
        """Start the run."""
        now = self._node.get_clock().now().to_msg()
        self._schedule_out.publish(graph_schedule(self.graph, now))
        self._node.destroy_subscription(self._diagnostics)
        self._track.begin()

    def look(self) -> Progress | None:
        """How far the run is; None before the first sample."""
        self._spin(2 * len(self.graph.struts))
        return self._track.progress()
