# SPDX-FileCopyrightText: 2026 The satvib authors
# SPDX-License-Identifier: Apache-2.0
"""Plants, sample by sample: what the sensors read, and what a voltage does."""

from typing import TYPE_CHECKING

from satvib_common.door import door

if TYPE_CHECKING:
    from satvib_plant_sim.plant.any_plant import AnyPlant, make_plant
    from satvib_plant_sim.plant.failing_plant import FailingPlant, make_failing_plant
    from satvib_plant_sim.plant.failures import Failure, check_failures
    from satvib_plant_sim.plant.identified_plant import IirPlant
    from satvib_plant_sim.plant.observation import Sample, Truth
    from satvib_plant_sim.plant.plant import Plant

__all__ = [
    'AnyPlant',
    'FailingPlant',
    'Failure',
    'IirPlant',
    'Plant',
    'Sample',
    'Truth',
    'check_failures',
    'make_failing_plant',
    'make_plant',
]
__getattr__, __dir__ = door(__name__, __file__)
