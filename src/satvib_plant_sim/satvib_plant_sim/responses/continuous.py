# SPDX-FileCopyrightText: 2026 The satvib authors
# SPDX-License-Identifier: Apache-2.0
"""The linear rig for analysis: state space, frequency response, and the transfer from the source to the lower plate.

Latency, hold and sampling are left out; `one_strut` and `all_struts` have them.
"""

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike
from satvib_common.arrays import Array, Complex, Integers

from satvib_plant_sim.physics.mechanics import input_columns, mechanics
from satvib_plant_sim.physics.state import size_of, state_of
from satvib_plant_sim.rig.rig import Rig
from satvib_plant_sim.rig.structure import MOTIONS
from satvib_plant_sim.stepping.design import layout_of
from satvib_plant_sim.stepping.discretize import full_system, output_rows


@dataclass(frozen=True)
class StateSpace:
    """x' = A x + B u, y = C x + D u.

    Attributes:
        A, B, C, D: matrices; without stops and limits.
        inputs: voltage_1.. (V), base (m/s^2, the source), payload (N); of listed struts base_x, .., base_rz (m/s^2,
            rad/s^2), payload_x, .., payload_rz (N, N m).
        outputs: upper_1.., lower (m/s^2, true), then read_upper_1.., read_lower (m/s^2, at the converters); of listed
            struts lower_1.. and read_lower_1..
    """

    A: Array
    B: Array
    C: Array
    D: Array
    inputs: tuple[str, ...]
    outputs: tuple[str, ...]


def state_space(rig: Rig) -> StateSpace:
    """Give the continuous-time linear rig with its sensor chains."""
    size = size_of(rig)
    system, layout = full_system(rig), layout_of(size)
    read = len(system.C) // 2
    index = np.arange(len(system.A))
    lanes = (index - layout.driving) % layout.lanes
    used = (index < layout.state) | ((index >= layout.driving) & (lanes < read))
    u = slice(0, input_columns(size).payload.stop)
    struts = [str(i + 1) for i in range(size.struts)]
    listed = size.plate > 1
    true = [*(f'upper_{i}' for i in struts), *(f'lower_{i}' for i in struts if listed)]
    true += [] if listed else ['lower']
    sources = [f'{body}_{m}' for body in ('base', 'payload') for m in MOTIONS]
    return StateSpace(
        A=system.A[np.ix_(used, used)],
        B=system.B[used, u],
        C=system.C[:, used],
        D=system.D[:, u],
        inputs=(*(f'voltage_{i}' for i in struts), *(sources if listed else ('base', 'payload'))),
        outputs=(*true, *(f'read_{name}' for name in true)),
    )


def moving_states(rig: Rig) -> Integers:
    """Give the states (indices) of `state_space` that can move; the plate of a rigid shaker stays at its source."""
    size = size_of(rig)
    index = np.arange(len(state_space(rig).A))
    state = state_of(index, size)
    idle = [*state.plate, *state.plate_rate] if rig.shaker.rigid else []
    return np.setdiff1d(index, idle)


def frequency_response(rig: Rig, frequency: ArrayLike) -> Complex:
    """Give the response (..., outputs, inputs) of `state_space` at frequencies (...), Hz."""
    f = np.asarray(frequency, dtype=float)
    system = state_space(rig)
    eye = np.eye(len(system.A))
    flat = [
        system.C @ np.linalg.solve(2j * math.pi * x * eye - system.A, system.B) + system.D
        for x in f.ravel()
    ]
    return np.array(flat, dtype=complex).reshape(*f.shape, *system.D.shape)


def source_transfer(
    rig: Rig, frequency: float, direction: tuple[float, ...] | None = None
) -> float:
    """Give |T(jw)| from the source's acceleration to the lower plate's, at 0 V.

    Args:
        rig: the rig.
        frequency: Hz.
        direction: listed struts: factors of the source along and about x, y, z (6); T is the motion of the plate in
            that direction, with metres and radians taken together by the masses of the plate.
    """
    m = mechanics(rig)
    size = size_of(rig)
    base, lower = input_columns(size).base, output_rows(size).lower
    s = 2j * math.pi * frequency
    inner = s * np.eye(len(m.A)) - m.A
    if direction is None:
        x = np.linalg.solve(inner, m.B[:, base.start])
        return float(abs(m.C[lower.start] @ x + m.D[lower.start, base.start]))
    if rig.shaker.rigid:
        return 1.0
    d = np.array(direction)
    x = np.linalg.solve(inner, m.B[:, base] @ d)
    # the plate moves by the source's motion and its own, s^2 z
    moved = d + s * s * state_of(x, size).plate
    return float(abs(d @ (m.m_l * moved)) / (d @ (m.m_l * d)))
