# SPDX-FileCopyrightText: 2026 The satvib authors
# SPDX-License-Identifier: Apache-2.0
"""The grid of the truth, as fine as what moves on it needs.

Between two points of the grid a disturbance is a straight line. Of a tone of f Hz on a grid of r points per second that
leaves sinc^2(f / r) of its amplitude: 0.9979 at 40 points per period, 0.95 at 8. So the grid has at least 40 points per
period of the highest frequency of the disturbance, and 10 per period of the rig's highest mode, whose motion is exact
on any grid but would not be seen. A rig whose own grid is fine enough is given back as it is.
"""

import math
from collections.abc import Iterable
from typing import TypeVar

import numpy as np
from satvib_common.errors import SatvibError

from satvib_plant_sim.disturbance.base import POINTS_PER_PERIOD, Disturbance
from satvib_plant_sim.physics.mechanics import mechanics
from satvib_plant_sim.rig.identified_rig import IirRig
from satvib_plant_sim.rig.rig import Rig

AnyRigT = TypeVar('AnyRigT', Rig, IirRig, Rig | IirRig)

POINTS_PER_MODE = 10
_FINEST = 1e6  # Hz, of acquisition.fine_rate


def fitted_grid(rig: AnyRigT, disturbances: Iterable[Disturbance]) -> AnyRigT:
    """Give a rig whose truth is fine enough for some disturbances and for its own modes.

    Args:
        rig: as loaded; a rig of identified models has no truth between its samples, and is given back.
        disturbances: all that may shake it.

    Raises:
        SatvibError: a frequency at or above half the rate that the rig states, or beyond the finest grid.
    """
    if not isinstance(rig, Rig):
        return rig
    acquisition = rig.acquisition
    rate = acquisition.fine_steps * acquisition.sample_rate
    needed, cause = POINTS_PER_MODE * highest_mode(rig), 'rig: its highest mode'
    for disturbance in disturbances:
        disturbance.check_grid(rate)
        for part in disturbance.parts():
            key, frequency = part.highest()
            if POINTS_PER_PERIOD * frequency > needed:
                needed, cause = POINTS_PER_PERIOD * frequency, f'disturbance: {key}: {frequency} Hz'
    if needed <= rate * (1.0 + 1e-9):
        return rig
    steps = math.ceil(needed / acquisition.sample_rate - 1e-9)
    if steps * acquisition.sample_rate > _FINEST:
        raise SatvibError(
            f'{cause} needs a truth of {needed:.3g} points per second, more than {_FINEST:g}'
        )
    return rig.replace(acquisition=acquisition.replace(fine_rate=steps * acquisition.sample_rate))


def highest_mode(rig: Rig) -> float:
    """Highest frequency at which the rig itself oscillates at 0 V, Hz."""
    return float(np.max(np.abs(np.linalg.eigvals(mechanics(rig).A).imag)) / (2.0 * math.pi))
