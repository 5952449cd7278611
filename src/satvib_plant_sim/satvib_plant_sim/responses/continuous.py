# SPDX-FileCopyrightText: 2026 The satvib authors
# SPDX-License-Identifier: Apache-2.0
"""The linear rig for analysis: state space, frequency response, and the transfer from the source to the lower plate.

Latency, hold and sampling are left out; `one_strut` and `all_struts` have them.
"""

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike
from satvib_common.arrays import Array, Complex

from satvib_plant_sim.physics.mechanics import input_columns, mechanics
from satvib_plant_sim.physics.state import state_size
from satvib_plant_sim.rig.rig import Rig
from satvib_plant_sim.stepping.design import DRIVING, LANES
from satvib_plant_sim.stepping.discretize import full_system, output_rows


@dataclass(frozen=True)
class StateSpace:
    """x' = A x + B u, y = C x + D u.

    Attributes:
        A, B, C, D: matrices; without stops and limits.
        inputs: voltage_1.. (V), base (m/s^2, the source), payload (N).
        outputs: upper_1.., lower (m/s^2, true), then read_upper_1.., read_lower (m/s^2, at the converters).
    """

    A: Array
    B: Array
    C: Array
    D: Array
    inputs: tuple[str, ...]
    outputs: tuple[str, ...]


def state_space(rig: Rig) -> StateSpace:
    """Give the continuous-time linear rig with its sensor chains."""
    n = rig.struts.count
    system = full_system(rig)
    lanes = (np.arange(len(system.A)) - DRIVING) % LANES
    index = np.arange(len(system.A))
    used = (index < state_size(n)) | ((index >= DRIVING) & (lanes <= n))
    u = slice(0, input_columns(n).payload + 1)
    struts = [str(i + 1) for i in range(n)]
    true = [*(f'upper_{i}' for i in struts), 'lower']
    return StateSpace(
        A=system.A[np.ix_(used, used)],
        B=system.B[used, u],
        C=system.C[:, used],
        D=system.D[:, u],
        inputs=(*(f'voltage_{i}' for i in struts), 'base', 'payload'),
        outputs=(*true, *(f'read_{name}' for name in true)),
    )


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


def source_transfer(rig: Rig, frequency: float) -> float:
    """Give |T(jw)| from the source's acceleration to the lower plate's, at 0 V.

    Args:
        rig: the rig.
        frequency: Hz.
    """
    m = mechanics(rig)
    n = rig.struts.count
    base, lower = input_columns(n).base, output_rows(n).lower
    s = 2j * math.pi * frequency
    x = np.linalg.solve(s * np.eye(len(m.A)) - m.A, m.B[:, base])
    return float(abs(m.C[lower] @ x + m.D[lower, base]))
