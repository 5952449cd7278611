# SPDX-FileCopyrightText: 2026 The satvib authors
# SPDX-License-Identifier: Apache-2.0
"""The main loop of a process with one node or several: one thread, one executor, clean ends.

The loop runs on rclpy's EventsExecutor where there is one, and on the SingleThreadedExecutor otherwise. Its `spin()`
without a time limit dispatches nothing (a defect of rclpy 7.1), so it spins in slices.
"""

import contextlib
import gc
import time
from collections.abc import Callable, Sequence
from typing import Any

from rclpy.context import Context
from rclpy.duration import Duration
from rclpy.executors import Executor, SingleThreadedExecutor

from satvib_common.ros.delivery.exchange import RANKS, Exchange
from satvib_common.ros.loop.turns import Turns
from satvib_common.ros.node import DRAIN, SatvibNode

# s, the longest time between two looks at signals
_SLICE = 0.1
# s, the longest time in which nodes of one process work on each other's messages alone
_AMONG_THEMSELVES = 0.02
# s, for messages on their way when the process is ended, and when it ends because its work is done
_ACKNOWLEDGE, _DONE = 1.0, 5.0


def make_executor(context: Context | None = None) -> Executor:
    """Give the executor with the least cost per message that this rclpy has."""
    try:
        from rclpy.experimental import EventsExecutor
    except ImportError:  # before rclpy 7.1.4
        return SingleThreadedExecutor(context=context)
    return EventsExecutor(context=context)


def close_nodes(nodes: list[SatvibNode[Any]]) -> None:
    """Destroy nodes with all that keeps them alive, and empty the list."""
    for node in nodes:
        with contextlib.suppress(Exception):
            node.destroy_node()
        with contextlib.suppress(Exception):
            # rclpy offers no other way to it
            vars(node).pop('_state_machine').destroy_when_not_in_use()
    nodes.clear()
    gc.unfreeze()
    gc.collect()


class Host:
    """Nodes that share a process, a thread and an executor.

    Args:
        nodes: they are of one context.
        exchange: of their messages; None where there is one node.
    """

    def __init__(self, nodes: Sequence[SatvibNode[Any]], exchange: Exchange | None = None) -> None:
        self.nodes = list(nodes)
        self.exchange = exchange
        self._executor = make_executor(nodes[0].context)
        self._turns = turns = Turns(
            self._executor, lambda: sum(node.handled for node in self.nodes)
        )
        for node in nodes:
            self._executor.add_node(node)
            node.wake = turns.wake
        if exchange is not None:
            exchange.wake = turns.wake

    @property
    def ended(self) -> SatvibNode[Any] | None:
        """The node that has ended, one that failed before any other."""
        ended = [node for node in self.nodes if node.ended]
        return max(ended, key=lambda node: node.exit_code, default=None)

    def start(self) -> None:
        """Configure all nodes and then activate them, so that readers find the writers of this process.

        Raises:
            SatvibError, RunError: a node cannot be started.
        """
        starting = [node for node in self.nodes if node.autostart]
        for node in starting:
            node.configure_now()
        for node in starting:
            node.activate_now()

    def spin(self, each: Callable[[], None] | None = None) -> None:
        """Run until a node has ended; `each` is called between two slices of the loop."""
        exchange = self.exchange
        if exchange is not None:
            exchange.founding = False
        while self.ended is None and self.nodes[0].context.ok():
            wait = min(node.tick() if node.active else _SLICE for node in self.nodes)
            if exchange is not None:
                exchange.work(time.monotonic() + min(wait, _AMONG_THEMSELVES))
                wait = 0.0 if exchange.waits() else wait
            if each is not None:
                each()
            alone = len(self.nodes) == 1 and self.nodes[0].active
            pause = self.nodes[0].pause() if alone else 0.0
            if pause > 0.0:
                time.sleep(pause)
                wait = 0.0
            if self.ended is None:
                self._turns.take(min(wait, _SLICE))

    def end(self) -> None:
        """Work on what has been received, bring all nodes to rest, and wait until others have what they said."""
        self._drain()
        for rank in range(RANKS):
            for node in self.nodes:
                if node.rank == rank and node.active:
                    node.trigger_deactivate()
            if self.exchange is not None:
                self.exchange.work(time.monotonic() + DRAIN)
        self._acknowledge()

    def close(self) -> None:
        """Leave nothing behind: the nodes vanish from the graph.

        The executor and the state machine of a lifecycle node keep the participant of DDS alive; without this, an ended
        node stays in the graph until its lease is over, some twenty seconds.
        """
        self._turns.close()
        with contextlib.suppress(Exception):
            self._executor.shutdown(0.0)
        del self._executor, self._turns
        close_nodes(self.nodes)

    def _drain(self) -> None:
        """Process what has been received, if no source sends any more; a live source would never end."""
        deadline = time.monotonic() + DRAIN
        if self.exchange is not None:
            # a loop that has been interrupted would go on for ever
            self.exchange.work(time.monotonic() + _AMONG_THEMSELVES)
        while all(node.exit_code == 0 for node in self.nodes):
            working = [node for node in self.nodes if node.active]
            if not working or any(node.sources_left() for node in working):
                return
            before = sum(node.handled for node in working)
            self._turns.take(0.02)
            if self.exchange is not None:
                self.exchange.work(time.monotonic() + _AMONG_THEMSELVES)
            if sum(node.handled for node in working) == before or time.monotonic() > deadline:
                return

    def _acknowledge(self) -> None:
        """Wait until every reader has what was published."""
        done = any(node.ended and node.last_line and node.exit_code == 0 for node in self.nodes)
        deadline = time.monotonic() + (_DONE if done else _ACKNOWLEDGE)
        for writer in (writer for node in self.nodes for writer in node.writers()):
            left = max(deadline - time.monotonic(), 0.0)
            with contextlib.suppress(Exception):
                writer.wait_for_all_acked(Duration(seconds=left))
