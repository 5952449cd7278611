# SPDX-FileCopyrightText: 2026 The satvib authors
# SPDX-License-Identifier: Apache-2.0
"""A fixed controller on the sampled rig: the whole loop as one matrix."""

import numpy as np
from satvib_common.arrays import Array, Complex
from satvib_control.laws.state_space.matrices import Matrices
from satvib_plant_sim.responses.all_struts import SampledRig, sampled_rig
from satvib_plant_sim.rig.rig import Rig


def for_every_strut(one: Matrices, count: int) -> Matrices:
    """Give the controller of one strut at each of `count` struts, as one with all readings and voltages."""
    eye = np.eye(count)
    return Matrices(*(np.asarray(np.kron(eye, matrix), dtype=float) for matrix in one))


def closed_loop_matrix(plant: SampledRig, controller: Matrices) -> Array:
    """Give the matrix from state to state of plant, voltages on their way and controller, without a limit."""
    m, n, p = len(plant.A), plant.C.shape[0], len(controller.A)
    taps, late = len(plant.B), plant.late
    waiting = late + taps - 1
    law = m + n * waiting
    total = law + p
    u = np.zeros((n, total))
    u[:, law:], u[:, :m] = controller.C, controller.D @ plant.C
    found = np.zeros((total, total))
    found[:m, :m] = plant.A
    for i, B in enumerate(plant.B):
        if late + i == 0:
            found[:m] += B @ u
        else:
            place = m + n * (late + i - 1)
            found[:m, place : place + n] += B
    if waiting:
        found[m : m + n] = u
        found[m + n : law, m : law - n] = np.eye(n * (waiting - 1))
    found[law:, law:] = controller.A
    found[law:, :m] = controller.B @ plant.C
    found[law:] += controller.E @ u
    return found


def closed_loop_poles(rig: Rig, controller: Matrices) -> Complex:
    """Give the poles of a controller of all struts on a rig."""
    return np.asarray(
        np.linalg.eigvals(closed_loop_matrix(sampled_rig(rig), controller)), dtype=complex
    )
