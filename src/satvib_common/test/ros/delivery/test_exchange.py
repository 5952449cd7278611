# SPDX-FileCopyrightText: 2026 The satvib authors
# SPDX-License-Identifier: Apache-2.0
"""Messages between the nodes of one process."""

import time
from array import array

import pytest

pytest.importorskip('rclpy')
messages = pytest.importorskip('satvib_msgs.msg', exc_type=ImportError)

# the message generator that comes with ROS uses modules that Python 3.11 deprecates
pytestmark = pytest.mark.filterwarnings("ignore:module 'sre_:DeprecationWarning")


@pytest.fixture
def exchange():
    from satvib_common.ros.delivery.exchange import Exchange

    return Exchange(closed=True)


def listen(exchange, name, call, rank=0, raw=False):
    from satvib_common.ros.delivery.exchange import Reader

    reader = Reader(call, rank, raw)
    exchange.attach(name, reader)
    return reader


def test_a_copy_shares_nothing_with_a_message_that_is_refilled():
    """Truth: the message's own equality before, and what the copy holds after every field of the original changes."""
    from satvib_common.ros.delivery.exchange import copy_of

    model = messages.IirParameters(a=array('d', [1.0, 2.0]), reason='x', sequence=3)
    model.header.frame_id, model.header.stamp.sec = 'strut_1', 7
    copy = copy_of(model)
    assert copy == model
    model.header.stamp.sec, model.header.frame_id, model.a[0], model.reason = 8, 'y', 5.0, 'z'
    assert (copy.header.stamp.sec, copy.header.frame_id, copy.reason) == (7, 'strut_1', 'x')
    assert list(copy.a) == [1.0, 2.0]


def test_messages_come_in_order_and_the_first_rank_before_the_others(exchange):
    """Truth: by hand. What the first rank publishes in turn also goes before."""
    heard = []
    voltage = exchange.topic('v')

    def controller(message):
        heard.append(('controller', message.sequence))
        exchange.send(voltage, messages.VcaVoltage(sequence=message.sequence))

    listen(exchange, 'a', lambda m: heard.append(('identifier', m.sequence)), rank=1)
    listen(exchange, 'a', controller)
    listen(exchange, 'v', lambda m: heard.append(('plant', m.sequence)))
    for k in (0, 1):
        exchange.send(exchange.topic('a'), messages.StrutAcceleration(sequence=k))
    exchange.work(time.monotonic() + 10.0)
    first = [('controller', 0), ('controller', 1), ('plant', 0), ('plant', 1)]
    assert heard == [*first, ('identifier', 0), ('identifier', 1)]
    assert not exchange.waits()


def test_a_long_queue_does_not_wait_for_a_loop_that_never_rests(exchange):
    """Truth: a loop that publishes to itself for ever; the recorder still gets all but the newest few hundred."""
    topic, recorded = exchange.topic('a'), []

    def again(message):
        if message.sequence < 20_000:
            exchange.send(topic, messages.StrutAcceleration(sequence=message.sequence + 1))

    listen(exchange, 'a', again)
    listen(exchange, 'a', lambda m: recorded.append(m.sequence), rank=2)
    exchange.send(topic, messages.StrutAcceleration())
    behind = []
    while exchange.waits():
        exchange.work(time.monotonic())
        behind.append(len(exchange._queues[2]))
    assert recorded == list(range(20_001))
    assert min(behind[:-1], default=0) <= 200


def test_raw_readers_get_the_bytes_of_the_wire(exchange):
    """Truth: rclpy's own deserialization."""
    from rclpy.serialization import deserialize_message

    heard = []
    listen(exchange, 'v', heard.append, raw=True)
    sent = messages.VcaVoltage(sequence=5, voltage=1.25)
    text = exchange.send(exchange.topic('v'), sent)
    exchange.work(time.monotonic() + 1.0)
    assert heard == [text]
    assert deserialize_message(text, messages.VcaVoltage) == sent


def test_who_listens_late_gets_the_newest_and_who_has_left_nothing(exchange):
    """Truth: transient local of depth 1, by hand."""
    from satvib_common.ros.delivery.exchange import Reader

    first, late = [], []
    reader = listen(exchange, 'v', first.append)
    exchange.send(exchange.topic('v'), messages.VcaVoltage(sequence=1))
    exchange.attach('v', Reader(late.append, 0, raw=False), whole=True)
    exchange.detach('v', reader)
    exchange.work(time.monotonic() + 1.0)
    assert first == []
    assert [m.sequence for m in late] == [1]
