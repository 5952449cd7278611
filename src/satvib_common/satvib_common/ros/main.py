# SPDX-FileCopyrightText: 2026 The satvib authors
# SPDX-License-Identifier: Apache-2.0
"""The main function of every node: one process, one thread, one executor, clean ends.

The loop runs on rclpy's EventsExecutor where there is one, and on the SingleThreadedExecutor otherwise. Two defects
of rclpy 7.1 shape it: `EventsExecutor.spin()` without a time limit dispatches nothing, and with rclpy's own signal
handling the context is gone before the safe state can be published. So it spins in slices and handles SIGINT and
SIGTERM itself (also when a shell has set them to be ignored).
"""

import contextlib
import faulthandler
import signal
import sys
import time
from collections.abc import Callable, Sequence
from os import _exit
from pathlib import Path
from typing import Any, NoReturn

import rclpy
from rclpy.duration import Duration
from rclpy.executors import Executor, SingleThreadedExecutor
from rclpy.signals import SignalHandlerOptions
from rclpy.task import Future

from satvib_common.errors import RunError, SatvibError
from satvib_common.realtime import set_priority, set_processor, settle_memory
from satvib_common.ros.node import DRAIN, SatvibNode

# s, the longest time between two looks at signals
_SLICE = 0.1
# s, how long anything may take after the signal before the process ends regardless
_LAST_RESORT = DRAIN + 5.0
# s, for messages on their way when the process ends
_ACKNOWLEDGE = 1.0


def run_node(make: Callable[[], SatvibNode[Any]], args: Sequence[str] | None = None) -> NoReturn:
    """Run a node until it ends or a signal ends it, then end the process.

    A `SatvibError` is one line and exit code 2, a `RunError` one line and 1, a signal nothing and 0.

    By then the node and its context are destroyed and logs and files are closed. The end of the interpreter is left
    out: the middleware's threads are alive while its statics are taken apart, which now and then aborted a process
    that had done its work.
    """
    code = _until_the_end(make, args)
    sys.stdout.flush()
    sys.stderr.flush()
    _exit(code)


def _until_the_end(make: Callable[[], SatvibNode[Any]], args: Sequence[str] | None) -> int:
    signals = _Signals()
    rclpy.init(args=args, signal_handler_options=SignalHandlerOptions.NO)
    node: SatvibNode[Any] | None = None
    try:
        node = make()
        signals.attach(node)
        return _run(node)
    except (SatvibError, RunError) as error:
        _say(node.get_name() if node else Path(sys.argv[0]).stem, str(error))
        return 2 if isinstance(error, SatvibError) else 1
    finally:
        with contextlib.suppress(Exception):
            if node:
                node.destroy_node()
        rclpy.try_shutdown()
        signals.ignore()


def _run(node: SatvibNode[Any]) -> int:
    executor = make_executor()
    executor.add_node(node)
    if node.autostart:
        node.start()
    parameters = node.parameters
    warn = node.get_logger().warning
    set_processor(getattr(parameters, 'cpu', -1), warn)
    set_priority(getattr(parameters, 'priority', 0), warn)
    settle_memory()
    while not node.ended and rclpy.ok():
        wait = node.tick() if node.active else _SLICE
        node.wake = Future()
        pause = node.pause()
        if pause > 0.0:
            time.sleep(pause)
            wait = 0.0
        if not node.ended:
            executor.spin_until_future_complete(node.wake, timeout_sec=min(wait, _SLICE))
    _drain(node, executor)
    if node.active:
        node.trigger_deactivate()
    _acknowledge(node)
    if node.last_line:
        _say(node.get_name(), node.last_line)
    return node.exit_code


def make_executor() -> Executor:
    """Give the executor with the least cost per message that this rclpy has."""
    try:
        from rclpy.experimental import EventsExecutor
    except ImportError:  # before rclpy 7.1.4
        return SingleThreadedExecutor()
    return EventsExecutor()


def _drain(node: SatvibNode[Any], executor: Executor) -> None:
    """Process what has been received, if no source sends any more; a live source would never end."""
    deadline = time.monotonic() + DRAIN
    while node.exit_code == 0 and node.active and not node.sources_left():
        before = node.handled
        executor.spin_until_future_complete(Future(), timeout_sec=0.02)
        if node.handled == before or time.monotonic() > deadline:
            return


def _acknowledge(node: SatvibNode[Any]) -> None:
    """Wait until every reader has what was published."""
    deadline = time.monotonic() + _ACKNOWLEDGE
    for writer in node.writers():
        left = max(deadline - time.monotonic(), 0.0)
        with contextlib.suppress(Exception):
            writer.wait_for_all_acked(Duration(seconds=left))


def _say(name: str, line: str) -> None:
    sys.stderr.write(f'{name}: {line}\n')
    sys.stderr.flush()


class _Signals:
    """SIGINT and SIGTERM end the node; before there is one they end the process at once."""

    def __init__(self) -> None:
        self._node: SatvibNode[Any] | None = None
        for number in (signal.SIGINT, signal.SIGTERM):
            signal.signal(number, self._arrived)

    def ignore(self) -> None:
        """Ignore further signals, which would change the exit code."""
        for number in (signal.SIGINT, signal.SIGTERM):
            signal.signal(number, signal.SIG_IGN)

    def attach(self, node: SatvibNode[Any]) -> None:
        self._node = node

    def _arrived(self, number: int, _frame: object) -> None:
        if self._node is None:
            _exit(0)
        if self._node.ended:
            # SIGTERM may come several times: the kernel sends it once for each thread of a parent that has ended
            if number == signal.SIGINT:
                _exit(130)
            return
        # a thread of its own that needs neither the interpreter nor its locks; it prints where the process was
        faulthandler.dump_traceback_later(_LAST_RESORT, exit=True)
        self._node.interrupt()
