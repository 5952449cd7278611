# SPDX-FileCopyrightText: 2026 The satvib authors
# SPDX-License-Identifier: Apache-2.0
"""Where a node is made: alone in its process, or among others. No node class needs to know it.

with placed(exchange, namespace='/strut_1'):
    node = StrutControllerNode()
"""

import contextlib
from collections.abc import Iterator
from contextvars import ContextVar
from dataclasses import dataclass, field
from typing import Any

from satvib_common.ros.delivery.exchange import Exchange


@dataclass(frozen=True)
class Place:
    """What a node takes from its place.

    Attributes:
        exchange: of the process; None: the node is alone in it.
        options: of rclpy.node.Node: namespace, parameter_overrides, context ...
    """

    exchange: Exchange | None = None
    options: dict[str, Any] = field(default_factory=dict)


_PLACE: ContextVar[Place | None] = ContextVar('place', default=None)


def place_of_node() -> Place:
    """The place of the node that is being made."""
    return _PLACE.get() or Place()


@contextlib.contextmanager
def placed(exchange: Exchange | None, **options: Any) -> Iterator[None]:
    """Make nodes at a place."""
    token = _PLACE.set(Place(exchange, options))
    try:
        yield
    finally:
        _PLACE.reset(token)
