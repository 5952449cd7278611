# SPDX-FileCopyrightText: 2026 The satvib authors
# SPDX-License-Identifier: Apache-2.0
"""The base of every node: parameters from a schema, quality of service, diagnostics, the main loop."""

from typing import TYPE_CHECKING

from satvib_common.door import door

if TYPE_CHECKING:
    from satvib_common.ros.convert import doubles, nanoseconds, plan_of
    from satvib_common.ros.main import run_node
    from satvib_common.ros.node import SatvibNode
    from satvib_common.ros.parameters import NodeParameters
    from satvib_common.ros.qos import offered, wanted

__all__ = [
    'NodeParameters',
    'SatvibNode',
    'doubles',
    'nanoseconds',
    'offered',
    'plan_of',
    'run_node',
    'wanted',
]
__getattr__, __dir__ = door(__name__, __file__)
