# SPDX-FileCopyrightText: 2026 The satvib authors
# SPDX-License-Identifier: Apache-2.0
"""One process of the bare graph: satvib's topics, messages and quality of service, and no mathematics.

Its nodes answer at once with messages that they refill. A source stands in the place of the plant, and measures. What
satvib adds to this is what its mathematics and its care cost; the floor itself is what rclpy and the middleware cost.
"""

import json
import os
import sys
import time
from array import array
from collections.abc import Callable
from functools import partial
from pathlib import Path
from typing import Any

import numpy as np
import rclpy
from rclpy.node import Node
from satvib_common.realtime import settle_memory
from satvib_common.ros.host import make_executor
from satvib_common.ros.loop.turns import Turns
from satvib_common.ros.qos import offered, wanted
from satvib_experiment.recording.topics import TOPICS

from satvib_bringup.live.bench.usage import usage_of
from satvib_msgs import msg

_ALL = wanted(whole=True)
_SLICE = 0.1  # s
_SETTLE = 0.5  # s, after all have found each other


def controller(strut: str) -> Node:
    """Answer a sample with voltage and state; take models."""
    node = Node('controller', namespace=strut)
    voltage, state = msg.VcaVoltage(), msg.ControllerState(law='off')
    voltage_out = node.create_publisher(msg.VcaVoltage, 'voltage', offered())
    state_out = node.create_publisher(msg.ControllerState, 'controller_state', offered())

    def answer(sample: Any) -> None:
        voltage.header, voltage.sequence = sample.header, sample.sequence
        voltage_out.publish(voltage)
        state.header, state.sequence = sample.header, sample.sequence
        state_out.publish(state)

    node.create_subscription(msg.StrutAcceleration, 'acceleration', answer, _ALL)
    node.create_subscription(msg.IirParameters, 'identified_model', lambda _: None, _ALL)
    return node


def identifier(strut: str) -> Node:
    """Answer every voltage with a model of two poles and three coefficients."""
    node = Node('identifier', namespace=strut)
    model = msg.IirParameters(
        a=[0.1] * 2, b=[0.1] * 3, covariance=[0.1] * 25, standard_deviation=[0.1] * 5
    )
    out = node.create_publisher(msg.IirParameters, 'identified_model', offered())

    def answer(voltage: Any) -> None:
        model.header, model.sequence = voltage.header, voltage.sequence
        out.publish(model)

    node.create_subscription(msg.StrutAcceleration, 'acceleration', lambda _: None, _ALL)
    node.create_subscription(msg.VcaVoltage, 'voltage', answer, _ALL)
    return node


class Recorder:
    """Takes everything as bytes, and counts it."""

    def __init__(self, struts: list[str]) -> None:
        self.node = Node('recorder')
        self.heard = 0
        for strut in struts:
            for topic, kind in TOPICS.values():
                self.node.create_subscription(
                    getattr(msg, kind), f'{strut}/{topic}', self.take, _ALL, raw=True
                )

    def take(self, _message: bytes) -> None:
        """Count a message."""
        self.heard += 1


class Source:
    """Publishes samples and truth, and notes when the voltages come.

    Args:
        plan: struts, rate, seconds, realtime, readers of a sample, pids of the other processes, file of the result.
    """

    def __init__(self, plan: dict[str, Any]) -> None:
        self.plan, self.struts = plan, plan['struts']
        self.node = node = Node('source')
        self.samples = [
            msg.StrutAcceleration(sample_period=1.0 / plan['rate']) for _ in self.struts
        ]
        fine = array('d', [0.0] * 20)
        self.truths = [msg.StrutTruth(upper=fine, lower=fine) for _ in self.struts]
        self.samples_out = [
            node.create_publisher(msg.StrutAcceleration, f'{s}/acceleration', offered())
            for s in self.struts
        ]
        self.truths_out = [
            node.create_publisher(msg.StrutTruth, f'{s}/truth', offered()) for s in self.struts
        ]
        for i, strut in enumerate(self.struts):
            node.create_subscription(
                msg.VcaVoltage, f'{strut}/voltage', partial(self.take, i), _ALL
            )
        self.k, self.published = -1, [0.0]
        self.answered: set[int] = set()
        self.arrivals = array('d')
        executor = make_executor()
        self.turns = Turns(executor, lambda: len(self.arrivals))
        executor.add_node(node)

    def spin(self, seconds: float) -> None:
        """Take voltages for a while."""
        self.turns.take(seconds)

    def publish(self) -> None:
        """Publish the next sample, and the truth after it."""
        self.k += 1
        self.answered.clear()
        now = time.perf_counter()
        self.published.append(now)
        for message, out in zip(self.samples, self.samples_out, strict=True):
            message.sequence = self.k
            out.publish(message)
        for message, out in zip(self.truths, self.truths_out, strict=True):
            message.sequence = self.k
            out.publish(message)

    def take(self, strut: int, voltage: Any) -> None:
        """Note a voltage; in lockstep go on when all are there."""
        now, k = time.perf_counter(), int(voltage.sequence)
        self.arrivals.extend((strut, k, now - self.published[k + 1]))
        if k == self.k:
            self.answered.add(strut)
            if not self.plan['realtime'] and len(self.answered) == len(self.struts):
                self.publish()

    def run(self) -> None:
        """Wait for all, measure, and write the result."""
        plan = self.plan
        while any(out.get_subscription_count() < plan['readers'] for out in self.samples_out):
            self.spin(0.02)
        self.spin(_SETTLE)
        settle_memory()
        pids = plan['pids'] | {'source': os.getpid()}
        before, begin = usage_of(pids), time.perf_counter()
        first_sample = time.time()
        late = self.clocked(begin) if plan['realtime'] else self.lockstep(begin)
        took, after = time.perf_counter() - begin, usage_of(pids)
        samples = max(self.k, 1)
        result = {
            'samples_per_s': None if plan['realtime'] else samples / took,
            'cpu_of': {n: 1e3 * (after[n].cpu - before[n].cpu) / samples for n in after},
            'memory': max(u.memory for u in after.values()),
            'memory_all': sum(u.memory for u in after.values()),
            'late_samples': late,
            'samples': self.k,
            'first_sample': first_sample,
        }
        path = Path(plan['result'])
        np.save(path.with_suffix('.npy'), np.array(self.arrivals).reshape(-1, 3))
        path.write_text(json.dumps(result), encoding='utf-8')

    def lockstep(self, begin: float) -> int:
        """As fast as the answers come."""
        self.publish()
        while time.perf_counter() < begin + self.plan['seconds']:
            self.spin(_SLICE)
        return 0

    def clocked(self, begin: float) -> int:
        """At the pace of the clock; gives how many samples were a period too late."""
        period, late = 1.0 / self.plan['rate'], 0
        due = begin + period
        while due < begin + self.plan['seconds']:
            left = due - time.perf_counter()
            if left > 0.0:
                self.spin(left)
                continue
            late += -left > period
            self.publish()
            due += period
        self.spin(period)
        return late


def host(nodes: list[Node], pause: float = 0.0, handled: Callable[[], int] = lambda: 0) -> None:
    """Spin until the process is ended.

    Args:
        nodes: of this process.
        pause: s, between two looks at what has come.
        handled: counts the messages that have been worked on; with a pause all that have come are worked on.
    """
    executor = make_executor()
    turns = Turns(executor, handled)
    for node in nodes:
        executor.add_node(node)
    settle_memory()
    while True:
        if pause:
            time.sleep(pause)
        turns.take(0.0 if pause else _SLICE)


def main() -> None:
    """Run what the JSON in the first argument says."""
    plan = json.loads(sys.argv[1])
    rclpy.init()
    roles = plan['roles']
    if roles == ['source']:
        Source(plan).run()
        os._exit(0)
    if roles == ['recorder']:
        heard = Recorder(plan['struts'])
        host([heard.node], pause=0.02, handled=lambda: heard.heard)
    make = {'controller': controller, 'identifier': identifier}
    host([make[role](strut) for strut in plan['struts'] for role in roles])


if __name__ == '__main__':
    main()
