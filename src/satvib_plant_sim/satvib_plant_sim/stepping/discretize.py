# SPDX-FileCopyrightText: 2026 The satvib authors
# SPDX-License-Identifier: Apache-2.0
"""Exact discretization of a rig: from continuous matrices to the arrays that the period kernel runs on.

A sample period T is n_fine steps of h = T / n_fine. Over a step the voltages are straight lines, and so is the
disturbance between its exact values on the fine grid. With E(t) = exp(A t),

    x(h) = E(h) x + G0(h) u + G1(h) u',   G0(t) = int_0^t E(t-r) B dr,   G1(t) = int_0^t E(t-r) B r dr

which is exact for such inputs; all three come from one matrix exponential (Van Loan 1978). A voltage that jumps by dV,
or bends by dV', at theta h within the step adds G0(h - theta h) dV, or G1(h - theta h) dV': by superposition the two
parts of a divided step, each exact.

Layout of a state (R): sixteen slots for what drives everything, which are mechanics and coils (3n+2), two for the
voltages, two for the base's disturbance at both ends of a step; then the sensor chains, stage by stage, four lanes
each: the n upper sensors and the lower one (the lower plate is one body, so its chain is shared).
Slopes are per fine step, not per second.
"""

from dataclasses import dataclass
from functools import lru_cache

import numpy as np
from satvib_common.arrays import Array

from satvib_plant_sim.physics.matrix_exponential import exponential
from satvib_plant_sim.physics.mechanics import Mechanics, mechanics
from satvib_plant_sim.physics.sensor_chain import sensor_chain
from satvib_plant_sim.rig.rig import Rig

INPUTS = 16
LANES = 4


@dataclass(frozen=True)
class Discrete:
    """One rig, ready for the kernel; R rows, n struts, c stages of a sensor chain.

    Attributes:
        step: (16, R) the columns that multiply the first sixteen slots; those of the voltages are left to the kernel.
        push: (2, R) the same for the force on the payload at both ends of a step.
        chain: (c, c) within a chain.
        hold: (4, n, R) G0(h), G1(h), G0(h - theta h), G1(h - theta h) of the voltages.
        force: (n, R) G0(h) of the corrective forces.
        strut: (6, n) K, C, k, stroke limit, force limit, 1 where back-EMF acts (voltage drive).
        inertia: (n, n) H, 1/kg; then `point` (n,) h.
        shaker: (4,) k_s / m_l, c_s / m_l, 1 / m_l, 1 when rigid.
        stop: (3,) stiffness, damping, h.
        delay: whole periods, fine step and whether theta counts: when a voltage takes effect.
    """

    step: Array
    push: Array
    chain: Array
    hold: Array
    force: Array
    strut: Array
    inertia: Array
    point: Array
    shaker: Array
    stop: Array
    delay: tuple[int, int, int]
    theta: float


@dataclass(frozen=True)
class Full:
    """Mechanics and all sensor chains as one continuous system, in the row layout.

    x' = A x + B u, y = C x + D u; outputs: a (n), a_l, then the ADC inputs of the n upper and the lower sensor.
    """

    A: Array
    B: Array
    C: Array
    D: Array
    parts: Mechanics


def full_system(rig: Rig) -> Full:
    """Assemble mechanics and sensor chains."""
    n = rig.struts.count
    m = mechanics(rig)
    A_c, b_c, c_c = sensor_chain(rig.accelerometer, rig.acquisition)
    stages = len(b_c)
    size, base = 3 * n + 2, INPUTS
    total = base + LANES * stages
    A, B = np.zeros((total, total)), np.zeros((total, m.B.shape[1]))
    C, D = np.zeros((2 * (n + 1), total)), np.zeros((2 * (n + 1), m.B.shape[1]))
    A[:size, :size], B[:size] = m.A, m.B
    C[: n + 1, :size], D[: n + 1] = m.C, m.D
    for lane in range(n + 1):
        own = base + lane + LANES * np.arange(stages)
        A[np.ix_(own, own)] = A_c
        A[own, :size] = np.outer(b_c, m.C[lane])
        B[own] = np.outer(b_c, m.D[lane])
        C[n + 1 + lane, own] = c_c
    return Full(A, B, C, D, m)


def transition(A: Array, B: Array, t: float) -> tuple[Array, Array, Array]:
    """Give E(t), G0(t), G1(t) of the module's equations, with slopes per second."""
    size, inputs = B.shape
    big = np.zeros((size + 2 * inputs, size + 2 * inputs))
    big[:size, :size], big[:size, size : size + inputs] = A * t, B * t
    # with time counted in t, slopes stay near one and the matrix well scaled
    big[size : size + inputs, size + inputs :] = np.eye(inputs)
    E = exponential(big)
    return E[:size, :size], E[:size, size : size + inputs], E[:size, size + inputs :] * t


@lru_cache(maxsize=1024)
def discretize(rig: Rig) -> Discrete:
    """Make the kernel's arrays of a rig, about 10 kB; the last 1024 are kept."""
    n, acquisition = rig.struts.count, rig.acquisition
    system = full_system(rig)
    total, size = len(system.A), 3 * n + 2
    n_fine = acquisition.fine_steps
    h = acquisition.period / n_fine
    steps = acquisition.input_delay / h
    whole = round(steps) if abs(steps - round(steps)) < 1e-9 else int(steps)
    theta = max(steps - whole, 0.0) if abs(steps - round(steps)) >= 1e-9 else 0.0

    E, G0, G1 = transition(system.A, system.B, h)
    P0, P1 = G0, G1
    if theta > 0.0:
        _, P0, P1 = transition(system.A, system.B, h * (1.0 - theta))
    v, a_d, f_p, f = slice(0, n), n, n + 1, slice(n + 2, 2 * n + 2)
    # a straight line from u_0 to u_1 over the step
    ends = np.stack([G0 - G1 / h, G1 / h])
    step = np.zeros((INPUTS, total))
    step[:size] = E[:, :size].T
    step[size + 2 : size + 4] = ends[:, :, a_d]
    own = INPUTS + LANES * np.arange((total - INPUTS) // LANES)
    m, shaker = system.parts, rig.shaker
    return Discrete(
        step=step,
        push=ends[:, :, f_p].copy(),
        chain=E[np.ix_(own, own)].copy(),
        hold=np.stack([G0[:, v].T, G1[:, v].T / h, P0[:, v].T, P1[:, v].T / h]),
        force=np.ascontiguousarray(G0[:, f].T),
        strut=np.stack(
            [
                m.K,
                m.C_strut,
                m.k,
                np.full(n, rig.struts.stroke_limit),
                np.full(n, rig.coil.force_limit),
                np.full(n, float(rig.coil.drive == 'voltage')),
            ]
        ),
        inertia=m.H,
        point=m.h,
        shaker=np.array(
            [
                shaker.stiffness / shaker.mass,
                shaker.damping / shaker.mass,
                1.0 / shaker.mass,
                float(shaker.rigid),
            ]
        ),
        stop=np.array([rig.struts.stop_stiffness, rig.struts.stop_damping, h]),
        delay=(whole // n_fine, whole % n_fine, int(theta > 0.0)),
        theta=theta,
    )
