# SPDX-FileCopyrightText: 2026 The satvib authors
# SPDX-License-Identifier: Apache-2.0
"""Rigs: what they are made of, how they are loaded, and random ones."""

from typing import TYPE_CHECKING

from satvib_common.door import door

if TYPE_CHECKING:
    from satvib_plant_sim.rig.any_rig import (
        AnyRig,
        load_any_rig,
        rig_from_mapping,
        strut_count,
        without_noise,
    )
    from satvib_plant_sim.rig.fine_grid import fitted_grid
    from satvib_plant_sim.rig.identified_rig import IirRig
    from satvib_plant_sim.rig.payload_shapes import PayloadModes, payload_modes
    from satvib_plant_sim.rig.random_rig import random_build, random_parts, random_payload
    from satvib_plant_sim.rig.rig import Rig, load_rig, rig_names
    from satvib_plant_sim.rig.streams import Stream

__all__ = [
    'AnyRig',
    'IirRig',
    'PayloadModes',
    'Rig',
    'Stream',
    'fitted_grid',
    'load_any_rig',
    'load_rig',
    'payload_modes',
    'random_build',
    'random_parts',
    'random_payload',
    'rig_from_mapping',
    'rig_names',
    'strut_count',
    'without_noise',
]
__getattr__, __dir__ = door(__name__, __file__)
