# SPDX-FileCopyrightText: 2026 The satvib authors
# SPDX-License-Identifier: Apache-2.0
"""How messages go from node to node: through the middleware, or directly within a process; as objects or as bytes."""

from typing import TYPE_CHECKING

from satvib_common.door import door

if TYPE_CHECKING:
    from satvib_common.ros.delivery.endpoints import Input, Output
    from satvib_common.ros.delivery.exchange import Exchange
    from satvib_common.ros.delivery.wire import blank, wire_of

__all__ = [
    'Exchange',
    'Input',
    'Output',
    'blank',
    'wire_of',
]
__getattr__, __dir__ = door(__name__, __file__)
