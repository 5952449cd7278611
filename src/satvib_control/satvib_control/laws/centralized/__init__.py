# SPDX-FileCopyrightText: 2026 The satvib authors
# SPDX-License-Identifier: Apache-2.0
"""The law `centralized`: a PID controller for each mode of the payload, from all sensors to all voltages."""

from typing import TYPE_CHECKING

from satvib_common.door import door

if TYPE_CHECKING:
    from satvib_control.laws.centralized.law import Centralized
    from satvib_control.laws.centralized.parameters import CentralizedParameters

__all__ = [
    'Centralized',
    'CentralizedParameters',
]
__getattr__, __dir__ = door(__name__, __file__)
