# SPDX-FileCopyrightText: 2026 The satvib authors
# SPDX-License-Identifier: Apache-2.0
"""Who may reach the nodes of this machine over the network, and the settings of Fast DDS for it."""

from typing import TYPE_CHECKING

from satvib_common.door import door

if TYPE_CHECKING:
    from satvib_common.transport.reach import Reach, set_transport, warning

__all__ = ['Reach', 'set_transport', 'warning']
__getattr__, __dir__ = door(__name__, __file__)
