# SPDX-FileCopyrightText: 2026 The satvib authors
# SPDX-License-Identifier: Apache-2.0
"""Continuous-time equations of the isolator (the paper's Figs. 1-2) with coils and shaker.

Coordinates are relative to the shaker's source, whose acceleration a_d is prescribed: it enters as an inertial force
and nothing integrates to drift. Strut i stands at (x_i, y_i); the payload moves it by w_i = w + y_i alpha - x_i beta,
the lower plate by z; its stroke is s_i = w_i - z. With

    f_i = -K_i s_i - C_i s_i' + k_i i_i + F_i          force on the payload at strut i; the lower plate gets -f_i
    H   = S M^-1 S^T,  M = diag(m, J, J),  S = rows [1, y_i, -x_i]
    a   = H f + h F_p                                  absolute acceleration of the upper plate at the struts
    a_l = (-sum f_i - k_s z - c_s z') / m_l            absolute acceleration of the lower plate
    s'' = a - a_l,   z'' = a_l - a_d                   (rigid shaker: a_l = a_d, z = 0)
    L i' = V - R i - k s'                              voltage drive
    i' = w_a (g V - i)                                 current drive

State: s (n), s' (n), i (n), z, z'. Inputs: V (n), a_d, F_p, F (n); F_p is a force on the payload, F a corrective force
between the plates of a strut (stops, coil limit). For one strut M = m and S = 1. `state_of` and `input_columns` say
where each of them stands.
"""

import math
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np
from satvib_common.arrays import Array
from satvib_common.struts.motions import motion_matrix
from satvib_common.struts.names import strut_angles

from satvib_plant_sim.physics.state import state_of, state_size
from satvib_plant_sim.rig.rig import Rig


@dataclass(frozen=True)
class Mechanics:
    """x' = A x + B u, y = C x + D u with y = a (n), a_l; and what the nonlinear parts need.

    Attributes:
        A, B, C, D: see the module; sizes 3n+2, 2n+2 inputs, n+1 outputs.
        H: (n, n) 1/kg, acceleration of the payload at struts per force at struts.
        h: (n,) 1/kg, the same per disturbance force.
        S: (n, dof) from (w, alpha, beta) to w_i.
        M: (dof, dof) kg, kg m^2.
        K, C_strut, k: (n,) stiffness, damping and force constant of each strut.
    """

    A: Array
    B: Array
    C: Array
    D: Array
    H: Array
    h: Array
    S: Array
    M: Array
    K: Array
    C_strut: Array
    k: Array


class InputColumns(NamedTuple):
    """Where the inputs stand: voltages V, base a_d, force on the payload F_p, corrective forces F."""

    voltage: slice
    base: int
    payload: int
    force: slice


def input_columns(n: int) -> InputColumns:
    """Give the columns of the inputs of n struts."""
    return InputColumns(voltage=slice(0, n), base=n, payload=n + 1, force=slice(n + 2, 2 * n + 2))


def geometry(rig: Rig) -> Array:
    """Give S (n, dof): what the payload's motions (w, alpha, beta) move at each strut."""
    n = rig.struts.count
    if n == 1:
        return np.ones((1, 1))
    angles = strut_angles(n, math.radians(rig.struts.first_angle), turn=2.0 * math.pi)
    return motion_matrix(angles, rig.struts.radius)


def mass_matrix(rig: Rig) -> Array:
    """Give M (dof, dof) of the payload: kg, kg m^2."""
    m = rig.payload.mass
    if rig.struts.count == 1:
        return np.array([[m]])
    inertia = rig.payload.inertia
    if inertia is None:
        inertia = 0.55 * m * rig.struts.radius**2
    return np.diag([m, inertia, inertia])


def mechanics(rig: Rig) -> Mechanics:
    """Assemble the equations of a rig."""
    n = rig.struts.count
    S, M = geometry(rig), mass_matrix(rig)
    inverse = np.diag(1.0 / np.diag(M))
    H = S @ inverse @ S.T
    point = np.array([1.0, rig.payload.force_y, -rig.payload.force_x])[: S.shape[1]]
    h = S @ inverse @ point
    K = rig.struts.stiffness * np.array(rig.struts.stiffness_scale[:n])
    C = rig.struts.damping * np.array(rig.struts.damping_scale[:n])
    k = rig.coil.force_constant * np.array(rig.coil.force_scale[:n])

    size, inputs = state_size(n), 2 * n + 2
    s, v, i, (z, vz) = state_of(np.arange(size), n)
    u = input_columns(n)
    # strut forces as rows over the state and over the inputs
    fx, fu = np.zeros((n, size)), np.zeros((n, inputs))
    fx[s, s], fx[s, v], fx[s, i] = -K, -C, k
    fu[:, u.force] = np.eye(n)
    ax, au = H @ fx, H @ fu
    au[:, u.payload] = h
    shaker = rig.shaker
    lx, lu = np.zeros(size), np.zeros(inputs)
    if shaker.rigid:
        lu[u.base] = 1.0
    else:
        lx = -fx.sum(axis=0)
        lx[z] -= shaker.stiffness
        lx[vz] -= shaker.damping
        lx, lu = lx / shaker.mass, -fu.sum(axis=0) / shaker.mass

    A, B = np.zeros((size, size)), np.zeros((size, inputs))
    A[s, v] = 1.0
    A[v], B[v] = ax - lx, au - lu
    if not shaker.rigid:
        A[z, vz] = 1.0
        A[vz], B[vz] = lx, lu
        B[vz, u.base] -= 1.0
    if rig.coil.drive == 'voltage':
        A[i, i] = -rig.coil.resistance / rig.coil.inductance
        A[i, v] = -k / rig.coil.inductance
        B[i, u.voltage] = np.eye(n) / rig.coil.inductance
    else:
        wa = 2.0 * math.pi * rig.coil.bandwidth
        A[i, i] = -wa
        B[i, u.voltage] = np.eye(n) * (wa * rig.coil.transconductance)
    return Mechanics(
        A=A, B=B, C=np.vstack([ax, lx]), D=np.vstack([au, lu]),
        H=H, h=h, S=S, M=M, K=K, C_strut=C, k=k,
    )  # fmt: skip
