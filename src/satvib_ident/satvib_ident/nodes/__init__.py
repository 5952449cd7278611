# SPDX-FileCopyrightText: 2026 The satvib authors
# SPDX-License-Identifier: Apache-2.0
"""The node `strut_identifier`."""

from typing import TYPE_CHECKING

from satvib_common.door import door

if TYPE_CHECKING:
    from satvib_ident.nodes.strut_identifier_node import StrutIdentifierNode
    from satvib_ident.nodes.voltage_pairing import VoltagePairing

__all__ = [
    'StrutIdentifierNode',
    'VoltagePairing',
]
__getattr__, __dir__ = door(__name__, __file__)
