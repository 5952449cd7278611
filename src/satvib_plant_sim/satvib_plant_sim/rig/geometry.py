# SPDX-FileCopyrightText: 2026 The satvib authors
# SPDX-License-Identifier: Apache-2.0
"""Where the struts stand, as matrices: what the motions of payload and lower plate do along each strut.

Strut i pushes along the unit vector u_i through its foot p_i. A body that turns about c with omega and whose point c
moves with v makes the strut longer by

    u_i . (v + omega x (p_i - c)) = [u_i, (p_i - c) x u_i] . [v, omega]

any point of the line of action gives the same. For the payload c is the centre of gravity, for the lower plate the
origin of the frame. Struts on a circle push along z, and their payload has the motions w, alpha, beta (w alone for
one strut): u_i = (0, 0, 1) leaves [1, y_i, -x_i] of it.
"""

import math

import numpy as np
from satvib_common.arrays import Array
from satvib_common.errors import SatvibError
from satvib_common.struts.motions import motion_matrix
from satvib_common.struts.names import strut_angles

from satvib_plant_sim.rig.structure import MOTIONS, Payload, Shaker, Struts


def along_struts(struts: Struts, center: tuple[float, ...]) -> Array:
    """Give [u_i, (p_i - c) x u_i] (n, 6) of listed struts: m per m, m per rad."""
    rows = []
    for strut in struts.each:
        u = np.array(strut.along) / math.hypot(*strut.along)
        rows.append(np.concatenate([u, np.cross(np.array(strut.foot) - np.array(center), u)]))
    return np.array(rows)


def payload_matrix(payload: Payload, struts: Struts) -> Array:
    """Give J (n, dof): what the payload's motions do along each strut."""
    n = struts.count
    if struts.each:
        whole = along_struts(struts, payload.center_of_gravity)
        return whole[:, [MOTIONS.index(m) for m in payload.motions]]
    if n == 1:
        return np.ones((1, 1))
    angles = strut_angles(n, math.radians(struts.first_angle), turn=2.0 * math.pi)
    return motion_matrix(angles, struts.radius)


def plate_matrix(struts: Struts) -> Array:
    """Give P (n, 1) or (n, 6): what the lower plate's motions do along each strut."""
    if struts.each:
        return along_struts(struts, (0.0, 0.0, 0.0))
    return np.ones((struts.count, 1))


def mass_matrix(payload: Payload, struts: Struts) -> Array:
    """Give M (dof, dof) of the payload: kg, kg m^2."""
    m = payload.mass
    if struts.each:
        keep = [MOTIONS.index(motion) for motion in payload.motions]
        whole = np.zeros((6, 6))
        whole[:3, :3] = m * np.eye(3)
        if payload.inertia_tensor is not None:
            xx, yy, zz, xy, xz, yz = (*payload.inertia_tensor, 0.0, 0.0, 0.0)[:6]
            whole[3:, 3:] = [[xx, xy, xz], [xy, yy, yz], [xz, yz, zz]]
        return whole[np.ix_(keep, keep)]
    if struts.count == 1:
        return np.array([[m]])
    inertia = payload.inertia
    if inertia is None:
        inertia = 0.55 * m * struts.radius**2
    return np.diag([m, inertia, inertia])


def plate_masses(shaker: Shaker, struts: Struts) -> Array:
    """Give the masses (1,) or (6,) of the lower plate in its directions: kg, kg m^2."""
    mass = shaker.suspension.mass
    if not struts.each:
        return np.array([mass])
    inertia = shaker.inertia
    if inertia is None:
        feet = np.array([strut.foot for strut in struts.each])
        inertia = mass * float(np.mean(np.sum(feet * feet, axis=1)))
    return np.array([mass] * 3 + [inertia] * 3)


def force_matrix(payload: Payload, struts: Struts) -> Array:
    """Give G (dof, 1) or (dof, 6): what disturbance forces on the payload do to its motions.

    Struts on a circle have one force, along z; listed ones have three forces and three moments. The forces act at
    (force_x, force_y) from the centre of gravity.
    """
    x, y = payload.force_x, payload.force_y
    if not struts.each:
        return np.array([1.0, y, -x])[: 1 if struts.count == 1 else 3, None]
    whole = np.eye(6)
    whole[3:, :3] = [[0.0, 0.0, y], [0.0, 0.0, -x], [-y, x, 0.0]]
    return whole[[MOTIONS.index(motion) for motion in payload.motions]]


def check_geometry(payload: Payload, struts: Struts) -> None:
    """Refuse struts that cannot hold the payload, and keys of the other kind of rig.

    Raises:
        SatvibError: which key, and why.
    """
    listed = {
        'payload.inertia_tensor': payload.inertia_tensor is not None,
        'payload.center_of_gravity': payload.center_of_gravity != (0.0, 0.0, 0.0),
        'payload.motions': payload.motions != MOTIONS,
    }
    if not struts.each:
        for key, given in listed.items():
            if given:
                raise SatvibError(f'{key}: only a rig that lists its struts (struts.each) has it')
        return
    if payload.inertia is not None:
        raise SatvibError('payload.inertia: a rig that lists its struts has inertia_tensor')
    turns = any(motion.startswith('r') for motion in payload.motions)
    if turns and payload.inertia_tensor is None:
        raise SatvibError('payload.inertia_tensor: missing; the payload can turn')
    J = payload_matrix(payload, struts)
    # a rotation as the motion that it makes at the struts, so that metres and radians compare
    size = np.sqrt(np.mean(J * J, axis=0))
    rank = np.linalg.matrix_rank(J / np.where(size > 0.0, size, 1.0), tol=1e-6)
    if rank < J.shape[1]:
        raise SatvibError(
            f'struts.each: {struts.count} struts hold {rank} of the motions {", ".join(payload.motions)}; '
            'add struts, turn them, or name in payload.motions what is not guided'
        )
