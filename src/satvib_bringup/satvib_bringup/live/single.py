# SPDX-FileCopyrightText: 2026 The satvib authors
# SPDX-License-Identifier: Apache-2.0
"""All nodes of a graph in the process of the runner: real nodes, whose messages go to one another directly.

Outsiders see every topic, parameter and service as always; to a topic that nobody outside reads nothing is sent.
"""

import contextlib
import gc
import threading
import time
from collections.abc import Callable
from functools import partial
from importlib import import_module
from types import TracebackType
from typing import Any, Self

import rclpy
from rclpy.context import Context
from rclpy.logging import LoggingSeverity
from rclpy.parameter import Parameter
from satvib_common.errors import RunError, SatvibError
from satvib_common.realtime import settle_memory
from satvib_common.ros.delivery.endpoints import Input, Output
from satvib_common.ros.delivery.exchange import Exchange
from satvib_common.ros.host import Host, close_nodes
from satvib_common.ros.main import lone_node
from satvib_common.ros.node import SatvibNode
from satvib_common.ros.place import placed
from satvib_common.ros.qos import offered

from satvib_bringup.live.discovery import Discovery
from satvib_bringup.live.graph import Graph
from satvib_bringup.live.process import NodeSpec
from satvib_bringup.live.progress import Progress
from satvib_bringup.live.schedule_message import graph_schedule
from satvib_bringup.live.security.enclaves import RUNNER, enclave_arguments
from satvib_bringup.live.track import Track
from satvib_msgs.msg import Schedule, StrutProgress

_REPORT = 0.15  # s
_CLASSES = {
    'plant_sim': ('satvib_plant_sim.nodes.plant_sim_node', 'PlantSimNode'),
    'strut_controller': ('satvib_control.nodes.strut_controller_node', 'StrutControllerNode'),
    'centralized_controller': (
        'satvib_control.nodes.centralized_controller_node',
        'CentralizedControllerNode',
    ),
    'strut_identifier': ('satvib_ident.nodes.strut_identifier_node', 'StrutIdentifierNode'),
    'supervisor': ('satvib_control.nodes.supervisor_node', 'SupervisorNode'),
    'recorder': ('satvib_bringup.nodes.recorder_node', 'RecorderNode'),
}


class EndedError(RunError):
    """The run is over before its end.

    Args:
        message: one line.
        code: exit code; 2: something that a person must correct.
    """

    def __init__(self, message: str, code: int) -> None:
        super().__init__(message)
        self.code = code


class SingleRun:
    """The nodes of a graph in a context of their own, so that they can live in any process.

    Args:
        graph: what runs.
    """

    def __init__(self, graph: Graph) -> None:
        self.graph = graph
        self._context = Context()
        self._runner = lone_node(RUNNER, self._context, enclave_arguments(RUNNER))
        self._exchange = Exchange(closed=True)
        self._track = Track(graph)
        out = self._runner.create_publisher(Schedule, '/schedule', offered(1))
        self._schedule_out = Output(out, self._exchange, spared=False)
        self.discovery = Discovery(graph, self._runner, self._schedule_out)
        self._nodes: list[SatvibNode[Any]] = []
        self._host: Host | None = None

    def __enter__(self) -> Self:
        """Nothing runs yet."""
        return self

    def __exit__(
        self,
        kind: type[BaseException] | None,
        error: BaseException | None,
        trace: TracebackType | None,
    ) -> None:
        """Leave nothing behind."""
        if self._host is not None:
            self._host.close()
        self._host = None
        close_nodes(self._nodes)
        with contextlib.suppress(Exception):
            self._runner.destroy_node()
        rclpy.try_shutdown(context=self._context)

    @property
    def samples(self) -> int:
        """How far it came."""
        seen = self._track.progress()
        return 0 if seen is None else seen.sequence + 1

    def start(self) -> float:
        """Make and activate the nodes and publish the schedule; gives the instant, s of the steady clock.

        Raises:
            EndedError: a node cannot be started.
        """
        spec: NodeSpec | None = None
        try:
            for spec in self.graph.nodes:
                self._nodes.append(self._make(spec))
            self._host = Host(self._nodes, self._exchange)
            self._host.start()
        except (SatvibError, RunError) as error:
            failed = [node.get_name() for node in self._nodes if node.failure]
            name = failed[0] if failed else spec.full_name if spec else ''
            raise EndedError(
                f'{name}: {error}', 2 if isinstance(error, SatvibError) else 1
            ) from None
        for strut in self.graph.struts:
            take = partial(self._track.take, strut)
            topic = f'/{strut}/progress'
            Input(self._runner, self._exchange, StrutProgress, topic, take, offered(1), rank=0)
        began = time.monotonic()
        self._track.begin()
        now = self._runner.get_clock().now().to_msg()
        self._schedule_out.publish(graph_schedule(self.graph, now))
        return began

    def run(
        self, interrupted: threading.Event, progress: Callable[[Progress], None] | None
    ) -> None:
        """Until the plant ends.

        Raises:
            EndedError: a node failed, or the run was interrupted.
        """
        assert self._host is not None
        reported = time.monotonic()

        def look() -> None:
            nonlocal reported
            if interrupted.is_set():
                raise EndedError('interrupted', 1)
            if time.monotonic() >= reported + _REPORT:
                reported = time.monotonic()
                seen = self._track.progress()
                if seen is not None and progress is not None:
                    progress(seen)

        settle_memory()
        try:
            self._host.spin(look)
        finally:
            self._host.end()
            gc.enable()
            gc.unfreeze()
        ended = self._host.ended
        if ended is not None and ended.exit_code:
            name = ended.get_fully_qualified_name().lstrip('/')
            raise EndedError(f'{name}: {ended.last_line}', ended.exit_code)
        failed = [node.failure for node in self._nodes if node.failure is not None]
        if failed:
            raise EndedError(str(failed[0]), 1)

    def _make(self, spec: NodeSpec) -> SatvibNode[Any]:
        module, name = _CLASSES[spec.executable]
        make = getattr(import_module(module), name)
        overrides = [Parameter(key, value=value) for key, value in spec.parameters.items()]
        with placed(
            self._exchange,
            context=self._context,
            namespace=spec.namespace,
            parameter_overrides=overrides,
            use_global_arguments=False,
        ):
            node: SatvibNode[Any] = make()
        # what nodes say in passing would stand between the lines of the runner
        node.get_logger().set_level(LoggingSeverity.WARN)
        return node
