# SPDX-FileCopyrightText: 2026 The satvib authors
# SPDX-License-Identifier: Apache-2.0
"""Fixtures of the system tests: real processes, real DDS, a domain of its own for every test.

Nothing sleeps: everything waits for an event, with a limit far above what is expected.
"""

import contextlib
import importlib.util
import os
import random
import signal
import subprocess
import time
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any

import pytest
import yaml

LIMIT = float(
    os.environ.get('SATVIB_TEST_LIMIT', '60')
)  # s, for anything that should take a second
HAS_ROS = importlib.util.find_spec('satvib_msgs') is not None and 'AMENT_PREFIX_PATH' in os.environ


def pytest_configure(config: pytest.Config) -> None:
    """The message generator that comes with ROS uses a module that Python 3.11 deprecates."""
    for module in ('sre_parse', 'sre_constants'):
        config.addinivalue_line(
            'filterwarnings', f"ignore:module '{module}' is deprecated:DeprecationWarning"
        )


def pytest_collection_modifyitems(items: list[pytest.Item]) -> None:
    """Live tests need the built and sourced workspace."""
    skip = pytest.mark.skip(reason='the workspace is not built and sourced; use ./satvib test')
    for item in items:
        if 'live' in Path(str(item.fspath)).name and not HAS_ROS:
            item.add_marker(skip)


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


@pytest.fixture(scope='session')
def new_domain() -> Callable[[Path], Any]:
    """The context manager, for runs that serve several tests."""
    return own_domain


@pytest.fixture
def domain(tmp_path: Path) -> Iterator[None]:
    """A domain for one test."""
    with own_domain(tmp_path):
        yield


class NodeProcess:
    """An installed executable with one node."""

    def __init__(self, package: str, executable: str, arguments: list[str], folder: Path) -> None:
        from satvib_bringup.live.workspace import executable as installed
        from satvib_bringup.live.workspace import graph_environment

        self.name = executable
        self.log = folder / f'{executable}-{time.monotonic_ns()}.log'
        self.sink = self.log.open('wb')
        command = [str(installed(package, executable)), '--ros-args', *arguments]
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


@pytest.fixture
def start(domain: None, tmp_path: Path) -> Iterator[Callable[..., NodeProcess]]:  # noqa: ARG001
    """Start nodes: start(package, executable, namespace='/', **parameters)."""
    started: list[NodeProcess] = []

    def begin(
        package: str,
        executable: str,
        namespace: str = '/',
        more: tuple[str, ...] = (),
        **parameters: Any,
    ) -> NodeProcess:
        path = tmp_path / f'parameters-{len(started)}.yaml'
        path.write_text(yaml.safe_dump({'/**': {'ros__parameters': parameters}}))
        arguments = ['-r', f'__ns:={namespace}', *more]
        if parameters:
            arguments += ['--params-file', str(path)]
        started.append(NodeProcess(package, executable, arguments, tmp_path))
        return started[-1]

    yield begin
    for process in started:
        process.close()
        # shown by pytest when the test has failed
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

    def collect(self, kind: Any, topic: str, whole: bool = True) -> list[Any]:
        """A list that fills with the messages of a topic, however long the test looks elsewhere."""
        from satvib_common.ros.qos import wanted

        found: list[Any] = []
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


@pytest.fixture
def probe(domain: None) -> Iterator[Probe]:  # noqa: ARG001
    """A node of the test."""
    made = Probe()
    yield made
    made.close()
