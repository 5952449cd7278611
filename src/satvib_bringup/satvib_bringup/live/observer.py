# SPDX-FileCopyrightText: 2026 The satvib authors
# SPDX-License-Identifier: Apache-2.0
"""The runner's view of the live graph: which nodes are there, how far the run is, and the schedule that starts it.

The controllers' states are looked at a few times a second through readers of depth 1, whatever the rate of the loop.
"""

import contextlib
import time
from functools import partial
from types import TracebackType
from typing import Any, Self

import rclpy
from diagnostic_msgs.msg import DiagnosticArray
from rclpy.context import Context
from rclpy.executors import SingleThreadedExecutor
from rclpy.node import Node
from rclpy.qos import DurabilityPolicy, HistoryPolicy, QoSProfile, ReliabilityPolicy
from rclpy.signals import SignalHandlerOptions
from satvib_common.phases import Phase
from satvib_common.ros.qos import offered
from satvib_experiment.analysis.running_attenuation import RunningAttenuation

from satvib_bringup.live.discovery import REPORTS, Discovery
from satvib_bringup.live.graph import Graph
from satvib_bringup.live.progress import Progress
from satvib_bringup.live.schedule_message import graph_schedule
from satvib_msgs.msg import ControllerState, Schedule

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
        rclpy.init(context=self._context, signal_handler_options=SignalHandlerOptions.NO)
        self._node = Node('runner', context=self._context, start_parameter_services=False)
        self._executor = SingleThreadedExecutor(context=self._context)
        self._executor.add_node(self._node)
        self._schedule_out = self._node.create_publisher(Schedule, '/schedule', offered(1))
        self._states: dict[str, Any] = {}
        self._attenuation = RunningAttenuation(graph.onset, graph.sample_period, len(graph.struts))
        self.discovery = Discovery(graph, self._node, self._schedule_out)
        self._began = time.monotonic()
        if graph.realtime:
            self._diagnostics = self._node.create_subscription(
                DiagnosticArray, '/diagnostics', self.discovery.on_diagnostics, REPORTS
            )
        for strut in graph.struts:
            self._node.create_subscription(
                ControllerState,
                f'/{strut}/controller_state',
                partial(self._states.__setitem__, strut),
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
        if self.graph.realtime:
            self._spin(2 * len(self.graph.processes))
        return self.discovery.missing()

    def _spin(self, times: int) -> None:
        for _ in range(times):
            self._executor.spin_once(timeout_sec=0.0)

    def publish_schedule(self) -> None:
        """Start the run."""
        now = self._node.get_clock().now().to_msg()
        self._schedule_out.publish(graph_schedule(self.graph, now))
        if self.graph.realtime:
            self._node.destroy_subscription(self._diagnostics)
        self._began = time.monotonic()

    def look(self) -> Progress | None:
        """How far the run is; None before the first sample."""
        self._spin(2 * len(self.graph.struts))
        if not self._states:
            return None
        for i, strut in enumerate(self.graph.struts):
            if (state := self._states.get(strut)) is not None:
                self._attenuation.add(int(state.sequence), state.phase, state.upper_rms, i)
        newest = max(self._states.values(), key=lambda state: state.sequence)
        samples = int(newest.sequence) + 1
        elapsed = max(time.monotonic() - self._began, 1e-9)
        return Progress(
            phase=Phase(newest.phase),
            sequence=int(newest.sequence),
            end=self.graph.plan.end,
            time=samples * self.graph.sample_period,
            attenuation=tuple(self._attenuation.decibels.tolist()),
            speed=samples * self.graph.sample_period / elapsed,
        )
