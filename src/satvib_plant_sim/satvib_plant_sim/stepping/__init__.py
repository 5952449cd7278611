# SPDX-FileCopyrightText: 2026 The satvib authors
# SPDX-License-Identifier: Apache-2.0
"""The exact steps of a rig through time: discretization, hold, fine step, sample period."""

from typing import TYPE_CHECKING

from satvib_common.door import door

if TYPE_CHECKING:
    from satvib_plant_sim.stepping.discretize import Discrete, full_system, transition
    from satvib_plant_sim.stepping.period import advance_period

__all__ = ['Discrete', 'advance_period', 'full_system', 'transition']
__getattr__, __dir__ = door(__name__, __file__)
