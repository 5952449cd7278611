# SPDX-FileCopyrightText: 2026 The satvib authors
# SPDX-License-Identifier: Apache-2.0
"""A node of a person's tool: it looks at a running graph, is none of it, and is gone with the tool."""

from typing import Self

import rclpy
from rclpy.context import Context
from rclpy.executors import SingleThreadedExecutor
from satvib_common.ros.main import lone_node

from satvib_bringup.live.security.enclaves import TOOLS, enclave_arguments


class Visitor:
    """A context manager with a node in a context of its own.

    Args:
        name: of the node.
    """

    def __init__(self, name: str) -> None:
        self._context = Context()
        self._node = lone_node(name, self._context, enclave_arguments(TOOLS))
        self._executor = SingleThreadedExecutor(context=self._context)
        self._executor.add_node(self._node)

    def __enter__(self) -> Self:
        """The node is there already."""
        return self

    def __exit__(self, *_: object) -> None:
        """Leave the graph."""
        self._executor.shutdown()
        self._node.destroy_node()
        rclpy.try_shutdown(context=self._context)

    def _spin(self, seconds: float) -> None:
        self._executor.spin_once(timeout_sec=seconds)
