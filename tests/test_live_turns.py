# SPDX-FileCopyrightText: 2026 The satvib authors
# SPDX-License-Identifier: Apache-2.0
"""The turns of the main loop. Truth: the interpreter's own count of what it has allocated, and the order of events."""

import gc
import sys
import threading
import time
from contextlib import contextmanager
from itertools import pairwise

import pytest

TURNS = 2000


@pytest.fixture
def loop(domain):  # noqa: ARG001
    """An executor's turns, a node of it, and what it has heard."""
    import rclpy
    from rclpy.signals import SignalHandlerOptions
    from satvib_common.ros.host import make_executor
    from satvib_common.ros.loop.turns import Turns
    from satvib_common.ros.qos import wanted

    from satvib_msgs.msg import VcaVoltage

    context = rclpy.Context()
    rclpy.init(context=context, signal_handler_options=SignalHandlerOptions.NO)
    node = rclpy.create_node('turning', context=context)
    executor = make_executor(context)
    heard = []
    turns = Turns(executor, lambda: len(heard))
    executor.add_node(node)
    node.create_subscription(
        VcaVoltage, 'voltage', lambda m: heard.append(m.sequence), wanted(whole=True)
    )
    yield turns, node, heard
    turns.close()
    turns.wake()  # it is late, and does no harm
    executor.shutdown()
    node.destroy_node()
    rclpy.shutdown(context=context)


def test_a_turn_leaves_nothing_in_memory(loop):
    """A plant has 200 turns a second and more. Of one object for each of them an hour would make 20 MB.

    Allowed is half an object a turn: what leaks leaves one, and the first turns of an interpreter allocate a hundred.
    """
    turns, _, _ = loop
    assert left_by(lambda: turns.take(0.0)) < 0.5


def left_by(turn):
    """Objects that a turn leaves in memory, on average."""
    for _ in range(TURNS // 10):
        turn()
    gc.collect()
    before = sys.getallocatedblocks()
    for _ in range(TURNS):
        turn()
    return (sys.getallocatedblocks() - before) / TURNS


@contextmanager
def watching():
    """The turn of a page, which it takes twenty times a second."""
    from satvib_bringup.watch.graph import WatchedGraph
    from satvib_bringup.watch.live.listener import GraphListener

    listener = GraphListener(WatchedGraph())
    try:
        yield listener.work
    finally:
        listener.close()


@contextmanager
def measuring():
    """The turn of the source of the bare graph, which it takes at every sample."""
    import rclpy
    from satvib_bringup.live.bench.floor_process import Source
    from satvib_common.ros.main import init_ros

    init_ros(args=[])
    source = Source({'struts': ['strut_1'], 'rate': 200.0})
    try:
        yield lambda: source.spin(0.0)
    finally:
        source.turns.close()
        source.node.destroy_node()
        rclpy.shutdown()


@pytest.mark.parametrize('others', [watching, measuring])
def test_a_turn_of_others_leaves_nothing_either(domain, others):  # noqa: ARG001
    """Allowed is the same."""
    with others() as turn:
        assert left_by(turn) < 0.5


def test_a_page_takes_all_that_is_there(domain):  # noqa: ARG001
    """Truth: what was sent, in its order. A turn that takes one message alone would take one each time."""
    from diagnostic_msgs.msg import DiagnosticArray, DiagnosticStatus
    from rclpy.duration import Duration
    from satvib_bringup.watch.graph import WatchedGraph
    from satvib_bringup.watch.live.listener import GraphListener

    heard = []

    class Graph(WatchedGraph):
        def take_status(self, name, *_):
            heard.append(name)

    names = [str(number) for number in range(50)]
    listener = GraphListener(Graph())
    publisher = listener.node.create_publisher(DiagnosticArray, '/diagnostics', 100)
    listener.work()  # what has come before the first turn is one event
    while not publisher.get_subscription_count():
        listener.work()
    for name in names:
        publisher.publish(DiagnosticArray(status=[DiagnosticStatus(name=name)]))
    assert publisher.wait_for_all_acked(Duration(seconds=10))
    counts = [0]
    while len(heard) < len(names):
        listener.work()
        counts.append(len(heard))
    listener.close()
    assert heard == names
    assert max(b - a for a, b in pairwise(counts)) > 1


def test_a_turn_takes_all_that_is_there_and_ends_when_it_is_woken(loop):
    """A wake from another thread ends a turn of an hour; one that came before lets the next turn not wait."""
    from satvib_common.ros.qos import offered

    from satvib_msgs.msg import VcaVoltage

    turns, node, heard = loop
    publisher = node.create_publisher(VcaVoltage, 'voltage', offered())
    for k in range(100):
        publisher.publish(VcaVoltage(sequence=k))
    while len(heard) < 100:
        turns.take(0.01)
    assert heard == list(range(100))
    waker = threading.Thread(target=turns.wake)
    waker.start()
    turns.take(3600.0)
    waker.join()
    turns.wake()
    turns.take(3600.0)


def test_a_turn_ends_in_a_flood(loop):
    """Messages that come faster than they are worked on: else no tick would come, and nobody would see a signal.

    Each message takes a millisecond and brings two more. Truth: a turn of 10 ms ends long before a thousand of them.
    """
    from satvib_common.ros.qos import offered, wanted

    from satvib_msgs.msg import VcaVoltage

    turns, node, heard = loop
    publisher = node.create_publisher(VcaVoltage, 'flood', offered())

    def more(message):
        heard.append(message.sequence)
        if len(heard) >= 1000:
            turns.wake()
            return
        busy_until = time.perf_counter() + 0.001
        for _ in range(2):
            publisher.publish(message)
        while time.perf_counter() < busy_until:
            pass

    node.create_subscription(VcaVoltage, 'flood', more, wanted(whole=True))
    publisher.publish(VcaVoltage())
    while not heard:
        turns.take(0.01)
    turns.take(0.01)
    assert 1 < len(heard) < 1000
