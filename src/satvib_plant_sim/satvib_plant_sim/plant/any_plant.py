# SPDX-FileCopyrightText: 2026 The satvib authors
# SPDX-License-Identifier: Apache-2.0
"""The one place where a rig of either kind becomes a plant."""

from collections.abc import Sequence

from satvib_plant_sim.disturbance.base import Disturbance
from satvib_plant_sim.plant.identified_plant import IirPlant
from satvib_plant_sim.plant.plant import Plant
from satvib_plant_sim.rig.any_rig import AnyRig
from satvib_plant_sim.rig.identified_rig import IirRig
from satvib_plant_sim.rig.rig import Rig

AnyPlant = Plant | IirPlant


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
