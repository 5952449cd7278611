# SPDX-FileCopyrightText: 2026 The satvib authors
# SPDX-License-Identifier: Apache-2.0
"""Continuous-time equations of the isolator (the paper's Figs. 1-2) with coils and shaker.

Coordinates are relative to the shaker's source, whose acceleration a_d is prescribed: it enters as an inertial force
and nothing integrates to drift. Strut i follows its unit vector; the payload's motions q move its head by J q, those of
the lower plate, z, its foot by P z (`rig/geometry`); its stroke is s = J q - P z. With

    f_i = -K_i s_i - C_i s_i' + k_i i_i + F_i          force on the payload along strut i; the lower plate gets -f_i
    H   = J M^-1 J^T
    a   = H f + h F_p,  h = J M^-1 G                   absolute acceleration of the upper plate along the struts
    a_l = (-P^T f - k_s z - c_s z') / m_l              absolute acceleration of the lower plate, P a_l along the struts
    s'' = a - P a_l,   z'' = a_l - a_d                 (rigid shaker: a_l = a_d, z = 0)
    L i' = V - R i - k s'                              voltage drive
    i' = w_a (g V - i)                                 current drive

Struts on a circle push along z: q = (w, alpha, beta), M = diag(m, J, J), rows of J are [1, y_i, -x_i], z is one number
and P is ones. For one strut M = m and J = 1. Listed struts have up to six motions of the payload and six of the lower
plate; its suspension has the same k_s / m_l and c_s / m_l in all of them.

State: s (n), s' (n), i (n), z (b), z' (b). Inputs: V (n), a_d (b), F_p (p), F (n); F_p are forces and moments on the
payload, F a corrective force between the plates of a strut (stops, coil limit). `state_of` and `input_columns` say
where each of them stands.

With more struts than motions the strokes depend on each other. Rounding would make them part slowly, so what no motion
of the payload explains, N s with N = I - J J^+, is brought back: s'' gets -w^2 N s - 2 w N s' (Baumgarte 1972, Comp.
Meth. Appl. Mech. Eng. 1, 1), which is 0 for strokes that a payload can have.
"""

import math
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np
from satvib_common.arrays import Array

from satvib_plant_sim.physics.state import Size, lower_readings, size_of, state_of, state_size
from satvib_plant_sim.rig.geometry import (
    force_matrix,
    mass_matrix,
    payload_matrix,
    plate_masses,
    plate_matrix,
)
from satvib_plant_sim.rig.rig import Rig

_RETURN = 1000.0  # w, rad/s: how fast strokes come back that no payload can have


@dataclass(frozen=True)
class Mechanics:
    """x' = A x + B u, y = C x + D u with y = a (n), P a_l (l); and what the nonlinear parts need.

    Attributes:
        A, B, C, D: see the module; sizes 3n+2b, 2n+b+p inputs, n+l outputs. l is 1 where all lower sensors read the
            same, as under struts on a circle, else n.
        H: (n, n) 1/kg, acceleration of the payload along struts per force along struts.
        h: (n, p) 1/kg and 1/(kg m), the same per disturbance force and moment.
        S: (n, dof) J, from the payload's motions to the heads.
        P: (n, b) from the lower plate's motions to the feet.
        M: (dof, dof) kg, kg m^2.
        m_l: (b,) kg, kg m^2, masses of the lower plate.
        K, C_strut, k: (n,) stiffness, damping and force constant of each strut.
        stroke_limit, force_limit: (n,) m, N.
        L: (n,) H.
    """

    A: Array
    B: Array
    C: Array
    D: Array
    H: Array
    h: Array
    S: Array
    P: Array
    M: Array
    m_l: Array
    K: Array
    C_strut: Array
    k: Array
    stroke_limit: Array
    force_limit: Array
    L: Array


class InputColumns(NamedTuple):
    """Where the inputs stand: voltages V, base a_d, forces on the payload F_p, corrective forces F."""

    voltage: slice
    base: slice
    payload: slice
    force: slice


def input_columns(size: Size) -> InputColumns:
    """Give the columns of the inputs of a rig of a size."""
    n, b, p = size
    return InputColumns(
        voltage=slice(0, n),
        base=slice(n, n + b),
        payload=slice(n + b, n + b + p),
        force=slice(n + b + p, 2 * n + b + p),
    )


def _each(rig: Rig, name: str, common: float, scale: tuple[float, ...] | None = None) -> Array:
    """Give a quantity of every strut (n,)."""
    values = np.array(rig.struts.own(name, common))
    return values if scale is None else values * np.array(scale[: rig.struts.count])


def mechanics(rig: Rig) -> Mechanics:
    """Assemble the equations of a rig."""
    size = size_of(rig)
    n, b, p = size
    payload, struts, coil, shaker = rig.payload, rig.struts, rig.coil, rig.shaker
    S, P, M = payload_matrix(payload, struts), plate_matrix(struts), mass_matrix(payload, struts)
    m_l = plate_masses(shaker, struts)
    inverse = np.linalg.inv(M)
    H = S @ inverse @ S.T
    forces = np.ascontiguousarray(force_matrix(payload, struts).T)
    h = np.stack([S @ inverse @ force for force in forces], axis=1)
    K = _each(rig, 'stiffness', struts.stiffness, struts.stiffness_scale)
    C = _each(rig, 'damping', struts.damping, struts.damping_scale)
    k = _each(rig, 'force_constant', coil.force_constant, coil.force_scale)
    R, L = _each(rig, 'resistance', coil.resistance), _each(rig, 'inductance', coil.inductance)

    states, inputs = state_size(size), 2 * n + b + p
    s, v, i, z, vz = state_of(np.arange(states), size)
    u = input_columns(size)
    base = np.arange(u.base.start, u.base.stop)
    # strut forces as rows over the state and over the inputs
    fx, fu = np.zeros((n, states)), np.zeros((n, inputs))
    fx[s, s], fx[s, v], fx[s, i] = -K, -C, k
    fu[:, u.force] = np.eye(n)
    ax, au = H @ fx, H @ fu
    au[:, u.payload] = h
    # accelerations of the lower plate likewise
    lx, lu = np.zeros((b, states)), np.zeros((b, inputs))
    if shaker.rigid:
        lu[:, u.base] = np.eye(b)
    else:
        lx = -(P.T @ fx)
        each, plate = np.arange(b), shaker.suspension
        lx[each, z] -= plate.stiffness * (m_l / plate.mass)
        lx[each, vz] -= plate.damping * (m_l / plate.mass)
        lx, lu = lx / m_l[:, None], -(P.T @ fu) / m_l[:, None]

    A, B = np.zeros((states, states)), np.zeros((states, inputs))
    A[s, v] = 1.0
    A[v], B[v] = ax - P @ lx, au - P @ lu
    if n > S.shape[1]:
        apart = np.eye(n) - S @ np.linalg.pinv(S)
        A[np.ix_(v, s)] -= _RETURN * _RETURN * apart
        A[np.ix_(v, v)] -= 2.0 * _RETURN * apart
    if not shaker.rigid:
        A[z, vz] = 1.0
        A[vz], B[vz] = lx, lu
        B[vz, base] -= 1.0
    if coil.drive == 'voltage':
        A[i, i] = -R / L
        A[i, v] = -k / L
        B[i, u.voltage] = np.eye(n) / L[:, None]
    else:
        wa = 2.0 * math.pi * coil.bandwidth
        A[i, i] = -wa
        B[i, u.voltage] = np.eye(n) * (wa * coil.transconductance)
    rows = P[: lower_readings(size)]
    return Mechanics(
        A=A, B=B, C=np.vstack([ax, rows @ lx]), D=np.vstack([au, rows @ lu]),
        H=H, h=h, S=S, P=P, M=M, m_l=m_l, K=K, C_strut=C, k=k,
        stroke_limit=_each(rig, 'stroke_limit', struts.stroke_limit),
        force_limit=_each(rig, 'force_limit', coil.force_limit), L=L,
    )  # fmt: skip
