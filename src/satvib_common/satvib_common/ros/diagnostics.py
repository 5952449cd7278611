# SPDX-FileCopyrightText: 2026 The satvib authors
# SPDX-License-Identifier: Apache-2.0
"""The state of a node on /diagnostics, once a second."""

import contextlib
from typing import Any

from diagnostic_msgs.msg import DiagnosticArray, DiagnosticStatus, KeyValue
from rclpy.duration import Duration
from rclpy.node import Node

from satvib_common.ros.names import strut_of
from satvib_common.ros.qos import volatile

# what a figure that counts a topic's other side begins with
READERS_OF = 'readers of '
WRITERS_OF = 'writers of '

_LAST_MESSAGE = 0.5  # s, how long a reader may take to receive the last message


class Diagnostics:
    """Publishes one status per node; the message is built once and refilled."""

    def __init__(self, node: Node) -> None:
        self._node = node
        self._publisher = node.create_publisher(DiagnosticArray, '/diagnostics', volatile(100))
        self._status = DiagnosticStatus(
            name=node.get_fully_qualified_name(), hardware_id=strut_of(node.get_namespace())
        )
        self._message = DiagnosticArray(status=[self._status])

    def publish(
        self,
        active: bool,
        complaint: str,
        figures: dict[str, Any],
        well: str = 'all is well',
        failed: bool = False,
    ) -> None:
        """Publish the state: OK, WARN with a complaint (ERROR when `failed`), or STALE while inactive."""
        status = self._status
        if not active:
            status.level, status.message = DiagnosticStatus.STALE, 'not active'
        elif complaint:
            level = DiagnosticStatus.ERROR if failed else DiagnosticStatus.WARN
            status.level, status.message = level, complaint
        else:
            status.level, status.message = DiagnosticStatus.OK, well
        status.values = [
            KeyValue(key=key, value=f'{value:g}' if isinstance(value, float) else str(value))
            for key, value in figures.items()
        ]
        self._message.header.stamp = self._node.get_clock().now().to_msg()
        self._publisher.publish(self._message)

    def readers(self) -> int:
        """How many read it."""
        return int(self._publisher.get_subscription_count())

    def close(self) -> None:
        """Destroy the publisher after its last message has arrived."""
        with contextlib.suppress(Exception):
            self._publisher.wait_for_all_acked(Duration(seconds=_LAST_MESSAGE))
        self._node.destroy_publisher(self._publisher)
