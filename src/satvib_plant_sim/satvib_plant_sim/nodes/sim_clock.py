# SPDX-FileCopyrightText: 2026 The satvib authors
# SPDX-License-Identifier: Apache-2.0
"""The topic /clock of the simulation: the time of the newest sample, at most a hundred times a second."""

from typing import Any

from rclpy.qos import qos_profile_sensor_data
from rosgraph_msgs.msg import Clock
from satvib_common.ros.convert import set_stamp

_PERIOD = 0.01  # s of wall time between two messages


class SimClock:
    """The publisher of a node.

    Args:
        node: it.
    """

    def __init__(self, node: Any) -> None:
        self._node, self._message, self._at = node, Clock(), 0.0
        self._publisher = node.create_publisher(Clock, '/clock', qos_profile_sensor_data)

    def publish(self, stamp: int, now: float) -> None:
        """Publish the time of a sample (ns) at s of the steady clock, if a message is due."""
        if now - self._at >= _PERIOD:
            self._at = now
            set_stamp(self._message.clock, stamp)
            self._publisher.publish(self._message)

    def close(self) -> None:
        """Remove the publisher."""
        self._node.destroy_publisher(self._publisher)
