# SPDX-FileCopyrightText: 2026 The satvib authors
# SPDX-License-Identifier: Apache-2.0
"""The smallest controller: answers every sample of some struts with one voltage.

python answerer.py VOLTAGE STRUT...
"""

import sys

import rclpy
from rclpy.experimental import EventsExecutor
from rclpy.task import Future
from satvib_common.ros.qos import offered, wanted

from satvib_msgs.msg import StrutAcceleration, VcaVoltage


def main():
    voltage, struts = float(sys.argv[1]), sys.argv[2:]
    rclpy.init()
    node = rclpy.create_node(f'answerer_{struts[0]}')
    for strut in struts:
        out = node.create_publisher(VcaVoltage, f'/{strut}/voltage', offered())
        message = VcaVoltage(voltage=voltage)

        def answer(sample, out=out, message=message):
            message.header.stamp = sample.header.stamp
            message.sequence = sample.sequence
            out.publish(message)

        node.create_subscription(
            StrutAcceleration, f'/{strut}/acceleration', answer, wanted(whole=True)
        )
    executor = EventsExecutor()
    executor.add_node(node)
    while rclpy.ok():
        executor.spin_until_future_complete(Future(), timeout_sec=1.0)


if __name__ == '__main__':
    main()
