# SPDX-FileCopyrightText: 2026 The satvib authors
# SPDX-License-Identifier: Apache-2.0
"""What a rig of either kind, mechanical or identified, can be asked for."""

from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np
from satvib_common.arrays import Array, Complex

from satvib_plant_sim.disturbance import Disturbance
from satvib_plant_sim.physics.noise import noise_floor
from satvib_plant_sim.plant.identified_plant import IirPlant
from satvib_plant_sim.plant.plant import Plant
from satvib_plant_sim.responses.one_strut import discrete_strut_model
from satvib_plant_sim.rig.identified_rig import IirRig, load_any_rig
from satvib_plant_sim.rig.rig import Rig

AnyRig = Rig | IirRig
AnyPlant = Plant | IirPlant

__all__ = [
    'AnyPlant', 'AnyRig', 'load_any_rig', 'make_plant', 'noise_floor_of', 'rig_from_mapping',
    'strut_count', 'strut_response', 'without_noise',
]  # fmt: skip


def rig_from_mapping(data: Any, where: str = '') -> AnyRig:
    """Build a rig of the kind that its key `plant` says."""
    if isinstance(data, Mapping) and data.get('plant') == 'iir':
        return IirRig.from_mapping(data, where)
    return Rig.from_mapping(data, where)


def make_plant(
    rig: AnyRig | Sequence[AnyRig],
    disturbance: Disturbance | Sequence[Disturbance],
    seed: int | Sequence[int],
) -> AnyPlant:
    """Give the plant that fits a rig, or a batch of rigs of one kind."""
    first = rig if isinstance(rig, Rig | IirRig) else rig[0]
    if isinstance(first, IirRig):
        return IirPlant(rig, disturbance, seed)  # type: ignore[arg-type]
    return Plant(rig, disturbance, seed)  # type: ignore[arg-type]


def strut_count(rig: AnyRig) -> int:
    """Give the number of struts."""
    return len(rig.models) if isinstance(rig, IirRig) else rig.struts.count


def noise_floor_of(rig: AnyRig) -> float:
    """Give what a reading at rest shows, RMS about its mean, m/s^2."""
    return rig.noise_floor() if isinstance(rig, IirRig) else noise_floor(rig)


def without_noise(rig: AnyRig) -> AnyRig:
    """Give the same rig with perfect sensors: no noise, no quantization."""
    if isinstance(rig, IirRig):
        return rig.replace(noise_rms=0.0, quantum=0.0)
    return rig.replace(
        accelerometer=rig.accelerometer.replace(noise_rms=0.0),
        acquisition=rig.acquisition.replace(input_bits=0),
    )


def strut_response(rig: AnyRig, strut: int, frequency: Array) -> Complex:
    """Give the exact sampled response (f,) from a strut's voltage to its own reading, m/s^2 per V, at (f,) Hz."""
    if isinstance(rig, Rig):
        return discrete_strut_model(rig, strut).response(frequency)
    model = rig.models[strut]
    z = np.exp(-2j * np.pi * frequency * rig.acquisition.period)
    response: Complex = (
        z**model.delay * np.polyval(model.b[::-1], z) / np.polyval([*model.a[::-1], 1.0], z)
    )
    return response
