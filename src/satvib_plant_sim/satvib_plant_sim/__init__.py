# SPDX-FileCopyrightText: 2026 The satvib authors
# SPDX-License-Identifier: Apache-2.0
"""Simulated vibration isolators with any number of struts: rigs, physics, sensors, disturbances and failures.

plant = make_plant(load_rig('paper_3dof'), make_disturbance({'kind': 'sine', 'amplitude': 1, 'frequency': 10}), seed=1)
sample = plant.sample()
truth = plant.advance(voltage)
"""

from typing import TYPE_CHECKING

from satvib_common.door import door

if TYPE_CHECKING:
    from satvib_plant_sim.disturbance.base import Disturbance
    from satvib_plant_sim.disturbance.factory import disturbance_kinds, make_disturbance
    from satvib_plant_sim.physics.noise import noise_floor
    from satvib_plant_sim.plant.any_plant import AnyPlant, make_plant
    from satvib_plant_sim.plant.failing_plant import FailingPlant, make_failing_plant
    from satvib_plant_sim.plant.failures import Failure, check_failures
    from satvib_plant_sim.plant.identified_plant import IirPlant
    from satvib_plant_sim.plant.observation import Sample, Truth
    from satvib_plant_sim.plant.plant import Plant
    from satvib_plant_sim.responses.all_struts import rig_response, sampled_rig
    from satvib_plant_sim.responses.continuous import (
        frequency_response,
        source_transfer,
        state_space,
    )
    from satvib_plant_sim.responses.one_strut import discrete_strut_model, strut_response
    from satvib_plant_sim.rig.any_rig import (
        AnyRig,
        load_any_rig,
        rig_from_mapping,
        strut_count,
        without_noise,
    )
    from satvib_plant_sim.rig.identified_rig import IirRig
    from satvib_plant_sim.rig.payload_shapes import payload_modes
    from satvib_plant_sim.rig.random_rig import random_build, random_parts, random_payload
    from satvib_plant_sim.rig.rig import Rig, load_rig, rig_names

__all__ = [
    'AnyPlant',
    'AnyRig',
    'Disturbance',
    'FailingPlant',
    'Failure',
    'IirPlant',
    'IirRig',
    'Plant',
    'Rig',
    'Sample',
    'Truth',
    'check_failures',
    'discrete_strut_model',
    'disturbance_kinds',
    'frequency_response',
    'load_any_rig',
    'load_rig',
    'make_disturbance',
    'make_failing_plant',
    'make_plant',
    'noise_floor',
    'payload_modes',
    'random_build',
    'random_parts',
    'random_payload',
    'rig_from_mapping',
    'rig_names',
    'rig_response',
    'sampled_rig',
    'source_transfer',
    'state_space',
    'strut_count',
    'strut_response',
    'without_noise',
]
__getattr__, __dir__ = door(__name__, __file__)
