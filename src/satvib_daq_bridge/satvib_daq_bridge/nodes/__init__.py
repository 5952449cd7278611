# SPDX-FileCopyrightText: 2026 The satvib authors
# SPDX-License-Identifier: Apache-2.0
"""The node `daq_bridge`."""

from typing import TYPE_CHECKING

from satvib_common.door import door

if TYPE_CHECKING:
    from satvib_daq_bridge.nodes.daq_bridge_node import DaqBridgeNode

__all__ = ['DaqBridgeNode']
__getattr__, __dir__ = door(__name__, __file__)
