# SPDX-FileCopyrightText: 2026 The satvib authors
# SPDX-License-Identifier: Apache-2.0
"""The main function of every node process: priorities, signals, exit codes.

With rclpy's own signal handling the context is gone before the safe state can be published (a defect of rclpy 7.1), so
SIGINT and SIGTERM are handled here, also when a shell has set them to be ignored.
"""

import contextlib
import faulthandler
import re
import signal
import sys
import time
from collections.abc import Callable, Iterator, Sequence
from os import _exit
from pathlib import Path
from typing import Any, NoReturn

import rclpy
from rclpy.context import Context
from rclpy.exceptions import InvalidParameterTypeException, InvalidParameterValueException
from rclpy.impl.implementation_singleton import rclpy_implementation
from rclpy.node import Node
from rclpy.signals import SignalHandlerOptions

from satvib_common.errors import RunError, SatvibError
from satvib_common.realtime import set_niceness, set_priority, set_processor, settle_memory
from satvib_common.ros.delivery.exchange import Exchange
from satvib_common.ros.host import Host, close_nodes
from satvib_common.ros.node import DRAIN, SatvibNode
from satvib_common.ros.place import placed
from satvib_common.transport.reach import set_transport, warning

# s, how long anything may take after the signal before the process ends regardless
_LAST_RESORT = DRAIN + 5.0
# s, in which two SIGINT are one
_ONE_HAND = 1.0
# in real time, of a process by the first rank of its nodes; plant and controllers go first
NICENESS = (0, 5, 10)

Make = Callable[[], SatvibNode[Any]]


def init_ros(context: Context | None = None, args: Sequence[str] | None = None) -> None:
    """Start rclpy without its signal handling, closed to the network unless the user's settings open it.

    Args:
        context: to start; None: the one of the process.
        args: as of the command line; None: those of the process.

    Raises:
        SatvibError: an argument, a parameter file or a variable of the environment that ROS cannot read.
    """
    set_transport()
    with _refusals():
        rclpy.init(args=args, context=context, signal_handler_options=SignalHandlerOptions.NO)


def lone_node(name: str, context: Context, arguments: Sequence[str] = ()) -> Node:
    """Start a context and make a node in it that looks at a graph and is none of it: the runner, a tool.

    Args:
        name: of the node.
        context: not started yet.
        arguments: what follows `--ros-args`; none: those of the process.

    Raises:
        SatvibError: as `init_ros`, or the middleware cannot do what is asked of it.
    """
    init_ros(context, ['--ros-args', *arguments] if arguments else None)
    with _refusals():
        return Node(name, context=context, start_parameter_services=False)


@contextlib.contextmanager
def _refusals() -> Iterator[None]:
    """What rclpy refuses when it starts, or makes a node, was given from outside."""
    try:
        yield
    except rclpy_implementation.UnknownROSArgsError as error:
        raise SatvibError(f'no argument of ROS: {error}') from None
    except InvalidParameterTypeException as error:
        raise SatvibError(f'parameter {str(error).partition(": ")[0]}') from None
    except (InvalidParameterValueException, rclpy_implementation.RCLError) as error:
        raise SatvibError(refusal(str(error))) from None


def refusal(text: str) -> str:
    """What the message of an rclpy error says to people, in one line."""
    line = ' '.join(text.split()).removeprefix('failed to initialize rcl: ')
    # where in the sources of ROS
    line = re.sub(r',? at /\S+:\d+', '', line).replace("'. Error: ", "': ")
    if braces := re.search(r"'-p ([^\s:]+(?::[^\s:=]+)?):=[\[{].*[}\]]'", line):
        name = braces[1]
        line += (
            f'; a value with braces is a text, which needs quotes: -p "{name}:=\'{{key: value}}\'"'
        )
    return line


def run_node(make: Make, args: Sequence[str] | None = None) -> NoReturn:
    """Run a node until it ends or a signal ends it, then end the process.

    A `SatvibError` is one line and exit code 2, a `RunError` one line and 1, a signal nothing and 0.

    By then the node and its context are destroyed and logs and files are closed. The end of the interpreter is left
    out: the middleware's threads are alive while its statics are taken apart, which now and then aborted a process
    that had done its work.
    """
    run_nodes([make], args)


def run_nodes(makes: Sequence[Make], args: Sequence[str] | None = None) -> NoReturn:
    """Run several nodes in one process, as `run_node` does one; the first that ends ends all."""
    code = _until_the_end(makes, args)
    sys.stdout.flush()
    sys.stderr.flush()
    _exit(code)


def _until_the_end(makes: Sequence[Make], args: Sequence[str] | None) -> int:
    signals = _Signals()
    reach = set_transport()
    exchange = Exchange() if len(makes) > 1 else None
    nodes: list[SatvibNode[Any]] = []
    host: Host | None = None
    try:
        init_ros(args=args)
        for make in makes:
            with placed(exchange), _refusals():
                nodes.append(make())
            if signals.arrived:
                return 0
        if line := warning(reach):
            nodes[0].get_logger().warning(line)
        signals.attach(nodes)
        host = Host(nodes, exchange)
        return _run(host)
    except (SatvibError, RunError) as error:
        failed = [node.get_name() for node in nodes if node.failure] or [Path(sys.argv[0]).stem]
        _say(failed[0], str(error))
        return 2 if isinstance(error, SatvibError) else 1
    finally:
        signals.ignore()
        if host is not None:
            host.close()
        close_nodes(nodes)
        rclpy.try_shutdown()


def _run(host: Host) -> int:
    host.start()
    first = min(host.nodes, key=lambda node: node.rank)
    warn = first.get_logger().warning
    if not getattr(first.parameters, 'lockstep', False):  # there nothing is in a hurry
        set_niceness(NICENESS[first.rank])
    set_processor(getattr(first.parameters, 'cpu', -1), warn)
    set_priority(getattr(first.parameters, 'priority', 0), warn)
    settle_memory()
    host.spin()
    host.end()
    ended = host.ended
    if ended is None:
        return 0
    if ended.last_line:
        _say(ended.get_name(), ended.last_line)
    return ended.exit_code


def _say(name: str, line: str) -> None:
    sys.stderr.write(f'{name}: {line}\n')
    sys.stderr.flush()


class _Signals:
    """SIGINT and SIGTERM end the nodes; while there are none yet, what is being made is finished and taken apart.

    SIGTERM may come several times: the kernel sends it once for each thread of a parent that has ended. SIGINT may come
    twice, from the terminal and from a launcher. Another SIGINT after a second is a person's who does not want to wait.
    """

    def __init__(self) -> None:
        self._nodes: list[SatvibNode[Any]] = []
        self.arrived = 0.0  # s of the steady clock; 0: not yet
        for number in (signal.SIGINT, signal.SIGTERM):
            signal.signal(number, self._on_signal)

    def ignore(self) -> None:
        """Ignore further signals, which would change the exit code."""
        for number in (signal.SIGINT, signal.SIGTERM):
            signal.signal(number, signal.SIG_IGN)

    def attach(self, nodes: list[SatvibNode[Any]]) -> None:
        self._nodes = nodes
        if self.arrived:
            self._end()

    def _on_signal(self, number: int, _frame: object) -> None:
        now = time.monotonic()
        if self.arrived:
            if number == signal.SIGINT and now - self.arrived > _ONE_HAND:
                _exit(130)
            return
        self.arrived = now
        # a thread of its own that needs neither the interpreter nor its locks; it prints where the process was
        faulthandler.dump_traceback_later(_LAST_RESORT, exit=True)
        self._end()

    def _end(self) -> None:
        for node in self._nodes:
            node.interrupt()
