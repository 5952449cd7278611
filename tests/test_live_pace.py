# SPDX-FileCopyrightText: 2026 The satvib authors
# SPDX-License-Identifier: Apache-2.0
"""In lockstep a writer waits for a reader that is behind, and loses nothing."""

import signal
import subprocess
import sys
import time

import pytest

LIMIT = 60.0  # s
FIRST, LAST = (
    100,
    6500,
)  # samples; a writer keeps 1000 of them, or 5000 without the settings of Fast DDS
READER = f"""
import sys
import rclpy
from rclpy.qos import QoSProfile
from satvib_common.ros.qos import wanted
from satvib_msgs.msg import VcaVoltage

rclpy.init()
node = rclpy.create_node('reader')
heard = []
node.create_subscription(
    VcaVoltage, 'voltage', lambda m: heard.append(m.sequence), wanted(whole=True, depth={LAST + 1})
)
print('here', flush=True)
while not heard or heard[-1] < {LAST}:
    rclpy.spin_once(node)
print(heard == list(range({LAST + 1})), flush=True)
"""


@pytest.fixture
def reader(domain):  # noqa: ARG001
    process = subprocess.Popen(
        [sys.executable, '-c', READER], stdout=subprocess.PIPE, text=True, env=environment()
    )
    assert process.stdout is not None
    assert process.stdout.readline() == 'here\n'
    yield process
    process.kill()
    process.communicate()


def environment():
    from satvib_bringup.live.workspace import graph_environment

    return graph_environment()


def test_a_reader_that_stops_holds_the_writer_and_loses_nothing(reader):
    """Truth: the numbers 0 to LAST. The reader is stopped, and goes on when the writer has tried twice in vain."""
    import rclpy
    from satvib_common.ros.delivery.endpoints import Output
    from satvib_common.ros.qos import offered

    from satvib_msgs.msg import VcaVoltage

    tries = 0

    def given_up() -> bool:
        nonlocal tries
        tries += 1
        if tries == 2:
            reader.send_signal(signal.SIGCONT)
        return False

    context = rclpy.Context()
    rclpy.init(context=context)
    node = rclpy.create_node('writer', context=context)
    try:
        publisher = node.create_publisher(VcaVoltage, 'voltage', offered(paced=True))
        out = Output(publisher, None, spared=False, given_up=given_up)
        message = VcaVoltage()
        deadline = time.monotonic() + LIMIT
        while out.get_subscription_count() == 0:
            assert time.monotonic() < deadline
        most = 0
        for k in range(LAST + 1):
            message.sequence, tries = k, 0
            out.publish(message)
            most = max(most, tries)
            if k == FIRST:
                assert publisher.wait_for_all_acked(rclpy.duration.Duration(seconds=LIMIT))
                reader.send_signal(signal.SIGSTOP)
        assert most >= 2
        output, _ = reader.communicate(timeout=LIMIT)
        assert output == 'True\n'
    finally:
        node.destroy_node()
        rclpy.shutdown(context=context)


def test_a_reader_that_ends_with_its_first_message_gets_no_second(domain):  # noqa: ARG001
    """Truth: the first number. A node that listens again in real time would otherwise answer what is long over.

    The executor takes all messages that are there at once. They are there before it looks: another reader has them all.
    """
    import rclpy
    from rclpy.executors import SingleThreadedExecutor
    from rclpy.experimental import EventsExecutor
    from satvib_common.ros.delivery.endpoints import Input
    from satvib_common.ros.qos import offered, wanted

    from satvib_msgs.msg import VcaVoltage

    context = rclpy.Context()
    rclpy.init(context=context)
    nodes = [rclpy.create_node(name, context=context) for name in ('first', 'second')]
    executors = [EventsExecutor(context=context), SingleThreadedExecutor(context=context)]
    for node, executor in zip(nodes, executors, strict=True):
        executor.add_node(node)
    heard: list[int] = []
    all_of_them: list[int] = []

    def take(message):
        heard.append(message.sequence)
        ending.close()

    try:
        publisher = nodes[1].create_publisher(VcaVoltage, 'voltage', offered())
        for k in range(100):
            publisher.publish(VcaVoltage(sequence=k))
        whole = wanted(whole=True)
        ending = Input(nodes[0], None, VcaVoltage, 'voltage', take, whole, 0)
        other = Input(
            nodes[1],
            None,
            VcaVoltage,
            'voltage',
            lambda m: all_of_them.append(m.sequence),
            whole,
            0,
        )
        limit = time.monotonic() + LIMIT
        while len(all_of_them) < 100 and time.monotonic() < limit:
            executors[1].spin_once(timeout_sec=1.0)
        while not heard and time.monotonic() < limit:
            executors[0].spin_once(timeout_sec=1.0)
        assert len(all_of_them) == 100
        assert heard == [0]
        other.close()
    finally:
        for node, executor in zip(nodes, executors, strict=True):
            executor.shutdown()
            node.destroy_node()
        rclpy.shutdown(context=context)
