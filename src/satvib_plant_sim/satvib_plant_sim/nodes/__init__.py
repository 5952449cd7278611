# SPDX-FileCopyrightText: 2026 The satvib authors
# SPDX-License-Identifier: Apache-2.0
"""The node `plant_sim`, its parameters and its messages."""

from typing import TYPE_CHECKING

from satvib_common.door import door

if TYPE_CHECKING:
    from satvib_plant_sim.nodes.parameters import PlantParameters

__all__ = ['PlantParameters']
__getattr__, __dir__ = door(__name__, __file__)
