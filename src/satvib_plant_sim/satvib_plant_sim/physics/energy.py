# SPDX-FileCopyrightText: 2026 The satvib authors
# SPDX-License-Identifier: Apache-2.0
"""The energy stored in a rig. It can only decrease while nothing drives the rig.

    E = q'^T M q' / 2 + z'^T m_l z' / 2 + sum_i (K_i s_i^2 + k_c p_i^2 + L i_i^2) / 2 + z^T k_s z / 2

in coordinates relative to the source, J q' = s' + P z', p the penetration of the stops. The coils' energy counts under
voltage drive. Under current drive the amplifier is a source, and E decreases once its current is 0. The coil of a lost
actuator (force constant 0) takes no part in the motion.
"""

from collections.abc import Sequence

import numpy as np
from satvib_common.arrays import Array

from satvib_plant_sim.physics.mechanics import mechanics
from satvib_plant_sim.physics.state import size_of, state_of
from satvib_plant_sim.rig.rig import Rig


def stored_energy(rigs: Sequence[Rig], state: Array) -> Array:
    """Give the energy (trials,), J, of states (trials, at least `state_size`)."""
    energies = []
    for rig, x in zip(rigs, state, strict=True):
        m, shaker = mechanics(rig), rig.shaker
        s, v, i, z, vz = state_of(x, size_of(rig))
        motion = np.linalg.lstsq(m.S, v + m.P @ vz)[0]
        p = np.maximum(np.abs(s) - m.stroke_limit, 0.0)
        twice = motion @ m.M @ motion + np.sum(m.K * s * s)
        twice += rig.struts.stop_stiffness * np.sum(p * p)
        if not shaker.rigid:
            plate = shaker.suspension
            twice += np.sum(m.m_l * (vz * vz + plate.stiffness / plate.mass * z * z))
        if rig.coil.drive == 'voltage':
            twice += np.sum(m.L * i * i)
        energies.append(0.5 * twice)
    return np.array(energies)
