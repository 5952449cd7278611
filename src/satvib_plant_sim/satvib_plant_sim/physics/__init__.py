# SPDX-FileCopyrightText: 2026 The satvib authors
# SPDX-License-Identifier: Apache-2.0
"""The equations of mechanics, coils, stops, sensors and converters."""

from typing import TYPE_CHECKING

from satvib_common.door import door

if TYPE_CHECKING:
    from satvib_plant_sim.physics.energy import stored_energy
    from satvib_plant_sim.physics.mechanics import Mechanics
    from satvib_plant_sim.physics.modes import modal_frequencies, static_stiffness, strut_modes
    from satvib_plant_sim.physics.noise import noise_floor, quantum
    from satvib_plant_sim.physics.state import State, state_of

__all__ = [
    'Mechanics',
    'State',
    'modal_frequencies',
    'noise_floor',
    'quantum',
    'state_of',
    'static_stiffness',
    'stored_energy',
    'strut_modes',
]
__getattr__, __dir__ = door(__name__, __file__)
