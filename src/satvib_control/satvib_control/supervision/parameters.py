# SPDX-FileCopyrightText: 2026 The satvib authors
# SPDX-License-Identifier: Apache-2.0
"""Parameters of the node `supervisor`."""

from dataclasses import dataclass

from satvib_common.parameters import LoopParameters
from satvib_common.schema import Fixed, param


@dataclass(frozen=True, kw_only=True)
class SupervisorParameters(LoopParameters):
    """What the supervisor knows of the struts and their controllers."""

    struts: int = param(3, 'number of struts', minimum=1, read_only=Fixed.RIG)
    voltage_limit: float = param(
        20.0,
        'voltage limit of the controllers; a thousandth of it is no cause',
        unit='V',
        above=0.0,
        read_only=Fixed.GRAPH,
    )
    watch_floor: float = param(
        0.1,
        'vibration below which no strut is loud',
        unit='m/s^2',
        minimum=0.0,
        read_only=Fixed.PROTECTION,
    )
