# SPDX-FileCopyrightText: 2026 The satvib authors
# SPDX-License-Identifier: Apache-2.0
"""Exact discretization of a rig: from continuous matrices to the arrays that the period kernel runs on.

A sample period T is n_fine steps of h = T / n_fine. Over a step the voltages are straight lines, and so is the
disturbance between its exact values on the fine grid. With E(t) = exp(A t),

    x(h) = E(h) x + G0(h) u + G1(h) u',   G0(t) = int_0^t E(t-r) B dr,   G1(t) = int_0^t E(t-r) B r dr

which is exact for such inputs; all three come from one matrix exponential (Van Loan 1978). A voltage that jumps by dV,
or bends by dV', at theta h within the step adds G0(h - theta h) dV, or G1(h - theta h) dV': by superposition the two
parts of a divided step, each exact.

`design` has the layout of a row (R). Slopes are per fine step, not per second.
"""

from dataclasses import dataclass
from functools import lru_cache
from typing import NamedTuple

import numpy as np
from satvib_common.arrays import Array

from satvib_plant_sim.physics.matrix_exponential import exponential
from satvib_plant_sim.physics.mechanics import Mechanics, input_columns, mechanics
from satvib_plant_sim.physics.sensor_chain import sensor_chain
from satvib_plant_sim.physics.state import Size, lower_readings, size_of, state_size
from satvib_plant_sim.rig.rig import Rig
from satvib_plant_sim.stepping.design import (
    DesignArrays,
    DriveSlot,
    ShakerConstants,
    StopConstants,
    StrutConstants,
    VoltageColumns,
    layout_of,
)


class Delay(NamedTuple):
    """When a voltage takes effect: whole periods, then whole fine steps, then theta when `at_theta` is 1."""

    periods: int
    step: int
    at_theta: int


@dataclass(frozen=True)
class Discrete:
    """One rig, ready for the kernel: its constants, and the delay of its voltages."""

    arrays: DesignArrays
    delay: Delay


@dataclass(frozen=True)
class Full:
    """Mechanics and all sensor chains as one continuous system, in the row layout: x' = A x + B u, y = C x + D u.

    Inputs are those of `Mechanics`, outputs are `output_rows`.
    """

    A: Array
    B: Array
    C: Array
    D: Array
    parts: Mechanics


class OutputRows(NamedTuple):
    """Where the outputs stand: true accelerations of both plates, then what the converters read of them.

    The lower plate has one of each under struts on a circle, else one of each per strut.
    """

    upper: slice
    lower: slice
    read_upper: slice
    read_lower: slice


def output_rows(size: Size) -> OutputRows:
    """Give the rows of the outputs of a rig of a size."""
    n = size.struts
    true = n + lower_readings(size)
    return OutputRows(
        upper=slice(0, n),
        lower=slice(n, true),
        read_upper=slice(true, true + n),
        read_lower=slice(true + n, 2 * true),
    )


def full_system(rig: Rig) -> Full:
    """Assemble mechanics and sensor chains."""
    m = mechanics(rig)
    A_c, b_c, c_c = sensor_chain(rig.accelerometer, rig.acquisition)
    stages, layout = len(b_c), layout_of(size_of(rig))
    size, read, total = layout.state, len(m.C), layout.rows(stages)
    A, B = np.zeros((total, total)), np.zeros((total, m.B.shape[1]))
    C, D = np.zeros((2 * read, total)), np.zeros((2 * read, m.B.shape[1]))
    A[:size, :size], B[:size] = m.A, m.B
    C[:read, :size], D[:read] = m.C, m.D
    for lane in range(read):
        own = layout.driving + lane + layout.lanes * np.arange(stages)
        A[np.ix_(own, own)] = A_c
        A[own, :size] = np.outer(b_c, m.C[lane])
        B[own] = np.outer(b_c, m.D[lane])
        C[read + lane, own] = c_c
    return Full(A=A, B=B, C=C, D=D, parts=m)


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
    """Make the kernel's arrays of a rig, about 10 kB (six struts: 60 kB); the last 1024 are kept."""
    sizes, acquisition = size_of(rig), rig.acquisition
    n, b = sizes.struts, sizes.plate
    system, layout = full_system(rig), layout_of(sizes)
    total, size = len(system.A), state_size(sizes)
    n_fine = acquisition.fine_steps
    h = acquisition.period / n_fine
    steps = acquisition.input_delay / h
    whole = round(steps) if abs(steps - round(steps)) < 1e-9 else int(steps)
    theta = max(steps - whole, 0.0) if abs(steps - round(steps)) >= 1e-9 else 0.0

    E, G0, G1 = transition(system.A, system.B, h)
    P0, P1 = G0, G1
    if theta > 0.0:
        _, P0, P1 = transition(system.A, system.B, h * (1.0 - theta))
    u = input_columns(sizes)
    v = u.voltage
    # a straight line from u_0 to u_1 over the step
    ends = np.stack([G0 - G1 / h, G1 / h])
    step = np.zeros((layout.driving, total))
    step[:size] = E[:, :size].T
    first = size + DriveSlot.BASE
    step[first : first + 2 * b] = ends[:, :, u.base].transpose(0, 2, 1).reshape(2 * b, total)
    own = np.arange(layout.driving, total, layout.lanes)
    m, suspension = system.parts, rig.shaker.suspension
    arrays = DesignArrays(
        step=step,
        push=np.ascontiguousarray(ends[:, :, u.payload].transpose(2, 0, 1)),
        chain=E[np.ix_(own, own)].copy(),
        voltage=np.stack(
            VoltageColumns(
                level=G0[:, v].T, slope=G1[:, v].T / h,
                late_level=P0[:, v].T, late_slope=P1[:, v].T / h,
            )
        ),
        force=np.ascontiguousarray(G0[:, u.force].T),
        strut=np.stack(
            StrutConstants(
                stiffness=m.K,
                damping=m.C_strut,
                force_constant=m.k,
                stroke_limit=m.stroke_limit,
                force_limit=m.force_limit,
                back_emf=np.full(n, float(rig.coil.drive == 'voltage')),
            )
        ),
        inertia=m.H,
        point=np.ascontiguousarray(m.h.T),
        feet=m.P,
        plate=1.0 / m.m_l,
        shaker=np.array(
            ShakerConstants(
                stiffness=suspension.stiffness / suspension.mass,
                damping=suspension.damping / suspension.mass,
                rigid=float(rig.shaker.rigid),
            )
        ),
        stop=np.array(
            StopConstants(
                stiffness=rig.struts.stop_stiffness,
                damping=rig.struts.stop_damping,
                step_time=h,
            )
        ),
        theta=np.array(theta),
    )  # fmt: skip
    delay = Delay(periods=whole // n_fine, step=whole % n_fine, at_theta=int(theta > 0.0))
    return Discrete(arrays=arrays, delay=delay)
