# SPDX-FileCopyrightText: 2026 The satvib authors
# SPDX-License-Identifier: Apache-2.0
"""Processes and a node of the test, for live tests and for benchmarks: real processes, real DDS, a domain of one's own.

Nothing sleeps: everything waits for an event, with a limit far above what is expected.
"""

import contextlib
import os
import random
import signal
import subprocess
import sys
import time
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any

import pytest
import yaml

LIMIT = float(
    os.environ.get('SATVIB_TEST_LIMIT', '60')
)  # s, for anything that should take a second


@contextlib.contextmanager
def own_domain(folder: Path) -> Iterator[None]:
    """A free ROS domain, logs in a folder, message fields checked."""
    from domain_coordinator import domain_id
    from satvib_common.transport.reach import PROFILES, RANGE, set_transport

    with domain_id(lambda: random.randint(1, 100)) as number, pytest.MonkeyPatch.context() as patch:
        patch.setenv('ROS_DOMAIN_ID', str(number))
        patch.setenv('ROS_LOG_DIR', str(folder / 'ros_log'))
        patch.setenv('ROS_PYTHON_CHECK_FIELDS', '1')
        chosen = dict(os.environ)
        set_transport(chosen)
        for name in (PROFILES, RANGE):
            if name in chosen:
                patch.setenv(name, chosen[name])
        yield


def shared_memory(pid: int) -> set[str]:
    """Names of the files of Fast DDS in shared memory that a process uses: none, for a killed one would leave them."""
    lines = Path('/proc', str(pid), 'maps').read_text().splitlines()
    return {Path(line.split()[5]).name for line in lines if '/dev/shm/fastrtps_' in line}


def of_folder(folder: Path) -> list[int]:
    """Ids of the processes whose command line names a folder."""
    found = []
    for path in Path('/proc').glob('[0-9]*/cmdline'):
        with contextlib.suppress(OSError):
            if str(folder).encode() in path.read_bytes():
                found.append(int(path.parent.name))
    return found


class NodeProcess:
    """A process with one node or several, and what it says."""

    def __init__(self, name: str, command: list[str], folder: Path) -> None:
        from satvib_bringup.live.workspace import graph_environment

        self.name = name
        self.log = folder / f'{name}-{time.monotonic_ns()}.log'
        self.sink = self.log.open('wb')
        self.popen = subprocess.Popen(
            command,
            stdout=self.sink,
            stderr=subprocess.STDOUT,
            env=graph_environment(),
            cwd=folder,
            start_new_session=True,
        )

    def send(self, number: signal.Signals) -> None:
        self.popen.send_signal(number)

    def wait(self, limit: float = LIMIT) -> int:
        """Exit code."""
        return self.popen.wait(limit)

    @property
    def said(self) -> str:
        return self.log.read_text()

    def close(self) -> None:
        if self.popen.poll() is None:
            self.popen.kill()
        self.popen.wait()
        self.sink.close()


class Starter:
    """Starts nodes, and ends them all: start(package, executable, namespace='/', **parameters).

    Args:
        folder: for parameters and logs.
        quiet: do not print what they said.
    """

    def __init__(self, folder: Path, quiet: bool = False) -> None:
        self.folder, self.quiet = folder, quiet
        self.started: list[NodeProcess] = []

    def __call__(
        self,
        package: str,
        executable: str,
        namespace: str = '/',
        more: tuple[str, ...] = (),
        **parameters: Any,
    ) -> NodeProcess:
        from satvib_bringup.live.workspace import executable as installed

        path = self.folder / f'parameters-{len(self.started)}.yaml'
        path.write_text(yaml.safe_dump({'/**': {'ros__parameters': parameters}}))
        arguments = ['-r', f'__ns:={namespace}', *more]
        if parameters:
            arguments += ['--params-file', str(path)]
        command = [str(installed(package, executable)), '--ros-args', *arguments]
        self.started.append(NodeProcess(executable, command, self.folder))
        return self.started[-1]

    def script(self, path: Path, *arguments: object) -> NodeProcess:
        """Start a Python file that belongs to the tests."""
        command = [sys.executable, str(path), *map(str, arguments)]
        self.started.append(NodeProcess(path.stem, command, self.folder))
        return self.started[-1]

    def close(self) -> None:
        """End them, and show what they said: pytest prints it when the test has failed."""
        for process in self.started:
            process.close()
        for process in () if self.quiet else self.started:
            print(f'--- {process.name}: exit code {process.popen.returncode}\n{process.said}')


class Probe:
    """A node of the test, in a context of its own."""

    def __init__(self) -> None:
        import rclpy
        from rclpy.context import Context
        from rclpy.executors import SingleThreadedExecutor
        from rclpy.signals import SignalHandlerOptions

        self.context = Context()
        rclpy.init(context=self.context, signal_handler_options=SignalHandlerOptions.NO)
        self.node = rclpy.create_node('probe', context=self.context)
        self.executor = SingleThreadedExecutor(context=self.context)
        self.executor.add_node(self.node)
        self.clients: dict[str, Any] = {}
        self.readers: dict[str, Any] = {}

    def close(self) -> None:
        import rclpy

        self.executor.shutdown()
        self.node.destroy_node()
        rclpy.try_shutdown(context=self.context)

    def publisher(self, kind: Any, topic: str) -> Any:
        from satvib_common.ros.qos import offered

        return self.node.create_publisher(kind, topic, offered())

    def collect(
        self, kind: Any, topic: str, whole: bool = True, into: list[Any] | None = None
    ) -> list[Any]:
        """A list that fills with the messages of a topic, however long the test looks elsewhere."""
        from satvib_common.ros.qos import wanted

        found: list[Any] = [] if into is None else into
        self.readers[topic] = self.node.create_subscription(
            kind, topic, found.append, wanted(whole, depth=20_000)
        )
        return found

    def wait(self, condition: Callable[[], Any], limit: float = LIMIT) -> Any:
        """Work until the condition holds; gives what it gave."""
        deadline = time.monotonic() + limit
        while not (result := condition()):
            assert time.monotonic() < deadline, 'waited in vain'
            self.executor.spin_once(timeout_sec=0.05)
        return result

    def call(self, kind: Any, service: str, request: Any, again: bool = True) -> Any:
        """Call a service and give its response.

        ROS 2 loses a response when the server does not know the client's reader yet. A request that may be made twice
        is made again then; another gives None.
        """
        client = self.clients.get(service)
        if client is None:
            client = self.clients[service] = self.node.create_client(kind, service)
        self.wait(client.service_is_ready)
        deadline = time.monotonic() + LIMIT
        while time.monotonic() < deadline:
            future = client.call_async(request)
            patience = time.monotonic() + LIMIT / 6
            while not future.done() and time.monotonic() < patience:
                self.executor.spin_once(timeout_sec=0.05)
            if future.done():
                return future.result()
            if not again:
                return None
        raise AssertionError(f'{service} does not answer')

    def state_of(self, node: str) -> str:
        """Lifecycle state of a node."""
        from lifecycle_msgs.srv import GetState

        return self.call(GetState, f'{node}/get_state', GetState.Request()).current_state.label

    def change_state(self, node: str, transition: int) -> bool:
        """Trigger a lifecycle transition; false when the node refuses."""
        from lifecycle_msgs.msg import Transition
        from lifecycle_msgs.srv import ChangeState

        request = ChangeState.Request(transition=Transition(id=transition))
        response = self.call(ChangeState, f'{node}/change_state', request, again=False)
        return response is None or bool(response.success)
