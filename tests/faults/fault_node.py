# SPDX-FileCopyrightText: 2026 The satvib authors
# SPDX-License-Identifier: Apache-2.0
"""A node that does harm: between two topics, or as a stranger on one.

    python fault_node.py between    what leaves the plant goes on to the strut, and the voltages go back
    python fault_node.py stranger   what is heard on a topic is published there again, changed, at a rate

What it is to do is asked on /faults, as JSON; what it has done is said on /faults/said.
"""

import importlib
import json
import sys
import time

import rclpy
from mangling import Mangler, Mangling
from rclpy.duration import Duration
from rclpy.executors import SingleThreadedExecutor
from rclpy.experimental import EventsExecutor
from rclpy.serialization import serialize_message
from rclpy.task import Future
from satvib_common.ros.qos import offered, wanted
from std_msgs.msg import String

from satvib_msgs.msg import IirParameters, StrutAcceleration, VcaVoltage

# kind, from, to
WAYS = {
    'acceleration': (
        StrutAcceleration,
        '/plant/strut_1/acceleration',
        '/strut_1/acceleration',
    ),
    'voltage': (VcaVoltage, '/strut_1/voltage', '/plant/strut_1/voltage'),
    'identified_model': (
        IirParameters,
        '/plant/strut_1/identified_model',
        '/strut_1/identified_model',
    ),
}


class FaultNode:
    """What both kinds share: they are asked, and say what they have done."""

    def __init__(self, name: str) -> None:
        self.node = rclpy.create_node(name)
        self.out = self.node.create_publisher(String, '/faults/said', offered())
        self.node.create_subscription(String, '/faults', self._on_order, wanted(whole=True))
        self.name = name

    def _on_order(self, message: String) -> None:
        order = json.loads(message.data)
        if order.pop('who') == self.name:
            self.begin(order)

    def begin(self, order: dict) -> None:
        raise NotImplementedError

    def say(self, event: str, sequence: int | None = None) -> None:
        """Say that it has begun, or is done, and at which sample if that is known here."""
        self.out.publish(String(data=json.dumps({'event': event, 'sequence': sequence})))


class Between(FaultNode):
    """Passes messages on, and mangles `count` of those of one topic when it is asked."""

    def __init__(self) -> None:
        super().__init__('between')
        self.mangler: Mangler | None = None
        self.topic, self.left = '', 0
        self.outs = {}
        for topic, (kind, source, sink) in WAYS.items():
            self.outs[topic] = self.node.create_publisher(kind, sink, offered())
            self.node.create_subscription(
                kind, source, lambda m, t=topic: self._pass_on(t, m), wanted(whole=True)
            )

    def begin(self, order: dict) -> None:
        self.topic, self.left = order['topic'], order['count']
        self.mangler = Mangler(Mangling(**order['mangling']), order['seed'], serialize_message)
        self.begun = False

    def _pass_on(self, topic: str, message: object) -> None:
        out = self.outs[topic]
        if self.mangler is None or topic != self.topic:
            out.publish(message)
            return
        if not self.begun:
            self.begun = True
            self.say('begun', message.sequence)
        for one in self.mangler.take(message):
            out.publish(one)
        self.left -= 1
        if self.left == 0:
            for one in self.mangler.end():
                out.publish(one)
            assert self.mangler.touched > 0
            self.mangler = None
            self.say('done', message.sequence)


class Stranger(FaultNode):
    """Publishes on a topic of others: the newest message that it has heard there, or a blank one, with other values."""

    def __init__(self) -> None:
        super().__init__('stranger')
        self.timer = self.publisher = self.reader = None

    def begin(self, order: dict) -> None:
        package, name = order['kind'].split('/')
        kind = getattr(importlib.import_module(f'{package}.msg'), name)
        self.heard = kind() if order['blank'] else None
        self.is_sampled = order['topic'].rpartition('/')[2] in {'acceleration', 'voltage'}
        self.mangler = Mangler(Mangling(**order['mangling']), order['seed'], serialize_message)
        self.rate, self.count, self.left = order['rate'], order['count'], order['count']
        self.publisher = self.node.create_publisher(kind, order['topic'], offered())
        # where a message comes with each sample, the newest one; elsewhere what was said before, too
        self.reader = self.node.create_subscription(
            kind, order['topic'], self._hear, wanted(whole=not self.is_sampled)
        )
        # this node hears itself
        self.readers = order['readers'] + 1
        self.begun = 0.0  # s of the steady clock
        self.timer = self.node.create_timer(1.0 / min(self.rate, 500.0), self._publish)

    def _hear(self, message: object) -> None:
        if not self.begun:
            self.heard = message

    def _publish(self) -> None:
        if self.heard is None or self.publisher.get_subscription_count() < self.readers:
            return
        if not self.begun:
            self.begun = time.monotonic()
            self.say('begun', self.newest())
        due = 1 + (time.monotonic() - self.begun) * self.rate
        while self.left and self.count - self.left < due:
            self.mangler.touched += 1
            self.publisher.publish(self.mangler.change(self.heard))
            self.left -= 1
        if self.left == 0:
            self.node.destroy_timer(self.timer)
            self.publisher.wait_for_all_acked(Duration(seconds=5.0))
            self.node.destroy_publisher(self.publisher)
            self.node.destroy_subscription(self.reader)
            self.say('done')

    def newest(self) -> int | None:
        """The sample of now, where a message comes with each."""
        return self.heard.sequence if self.is_sampled else None


def main() -> None:
    rclpy.init()
    made = {'between': Between, 'stranger': Stranger}[sys.argv[1]]()
    # what is made in a callback is seen by this executor, and not by the fast one
    executor = EventsExecutor() if sys.argv[1] == 'between' else SingleThreadedExecutor()
    executor.add_node(made.node)
    while rclpy.ok():
        executor.spin_until_future_complete(Future(), timeout_sec=1.0)


if __name__ == '__main__':
    main()
