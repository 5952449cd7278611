# SPDX-FileCopyrightText: 2026 The satvib authors
# SPDX-License-Identifier: Apache-2.0
"""The motions of a payload from the motions at its struts, under the names that people who build isolators use."""

import numpy as np
from satvib_common.arrays import Array
from satvib_plant_sim.rig.any_rig import AnyRig
from satvib_plant_sim.rig.payload_shapes import payload_modes
from satvib_plant_sim.rig.rig import Rig
from satvib_plant_sim.rig.structure import MOTIONS

NAMES = {
    'w': 'heave', 'alpha': 'tilt_x', 'beta': 'tilt_y', 'z': 'heave', 'rx': 'tilt_x', 'ry': 'tilt_y',
}  # fmt: skip


def named_motions(rig: AnyRig | None) -> tuple[tuple[str, ...], Array]:
    """Give the names (m) of the motions and the matrix (m, n) that makes them of the motions along n struts.

    Turns are given as the motion that they make at the radius of the struts, so that all have one unit. Nothing (no
    names) for a rig that is not known or has no geometry.
    """
    if not isinstance(rig, Rig):
        return (), np.zeros((0, 0))
    found = payload_modes(rig)
    return tuple(NAMES.get(name, name) for name in found.names), found.mode


def along(rig: Rig, direction: tuple[float, ...]) -> Array:
    """Give a direction of the base (6) as motions of the payload (m), turns at the struts' radius; of length 1."""
    found = payload_modes(rig)
    if not rig.struts.each:
        return np.array([1.0] + [0.0] * (len(found.names) - 1))
    factors = np.array(
        [
            direction[MOTIONS.index(name)] * (found.radius if name.startswith('r') else 1.0)
            for name in found.names
        ]
    )
    return np.asarray(factors / max(float(np.linalg.norm(factors)), 1e-300))
