# SPDX-FileCopyrightText: 2026 The satvib authors
# SPDX-License-Identifier: Apache-2.0
"""What a fine step works on: the layout of a row, and the constants of one rig.

A row (R numbers) begins with sixteen slots that drive everything: the state of mechanics and coils (3n + 2), then
`DriveSlot`, then unused ones. The sensor chains follow, stage by stage, with four lanes each: the n upper sensors and
the lower one. The lower plate is one body, so its chain serves all struts.
"""

from enum import IntEnum
from typing import Any, NamedTuple

from satvib_common.arrays import Array
from satvib_common.kernels.deferred import njit

from satvib_plant_sim.physics.state import compiled_state_of

DRIVING = 16  # slots of a row before the sensor chains
LANES = 4  # sensor chains of a row


class DriveSlot(IntEnum):
    """What drives a fine step from outside; these slots follow the state."""

    ONE = 0  # 1: its column holds what the voltages add in each step
    STEP = 1  # index of the fine step: its column holds what the voltages add per index
    BASE_START = 2  # base acceleration at the start of the step, m/s^2
    BASE_END = 3  # and at its end


class Row(NamedTuple):
    """One row, and views of its parts.

    Attributes:
        whole: (R).
        state: `State`.
        drive: (4) `DriveSlot`.
    """

    whole: Any
    state: Any
    drive: Any


@njit
def row_of(whole, n):
    """Give the views of a row (R) for n struts."""
    return Row(
        whole=whole,
        state=compiled_state_of(whole, n),
        drive=whole[3 * n + 2 : 3 * n + 6],
    )


class StrutConstants(NamedTuple):
    """Constants of the struts, (n) each.

    Attributes:
        stiffness, damping: N/m, N s/m.
        force_constant: N/A.
        stroke_limit, force_limit: m, N.
        back_emf: 1 where back-EMF acts (voltage drive), else 0.
    """

    stiffness: Any
    damping: Any
    force_constant: Any
    stroke_limit: Any
    force_limit: Any
    back_emf: Any


class ShakerConstants(NamedTuple):
    """Constants of the shaker, divided by the mass of the lower plate; `rigid` is 1 when it gives way to nothing."""

    stiffness: Any
    damping: Any
    inverse_mass: Any
    rigid: Any


class StopConstants(NamedTuple):
    """Stiffness (N/m) and damping (N s/m) of a stop, and the length of a fine step (s)."""

    stiffness: Any
    damping: Any
    step_time: Any


class VoltageColumns(NamedTuple):
    """What the voltages add to a row in a step, (n, R) each: per V, and per V of change during the step.

    Attributes:
        level, slope: of the whole step, G0(h) and G1(h).
        late_level, late_slope: of the part behind theta, G0(h - theta h) and G1(h - theta h).
    """

    level: Any
    slope: Any
    late_level: Any
    late_slope: Any


class DesignArrays(NamedTuple):
    """The constants of one rig as plain arrays, in the order of the kernel's arguments; trials add a leading axis.

    Attributes:
        step: (16, R) the columns that multiply the first sixteen slots; the kernel fills those of the voltages.
        push: (2, R) the same for the force on the payload at both ends of a step.
        chain: (c, c) within a chain of c stages.
        voltage: (4, n, R) `VoltageColumns`.
        force: (n, R) G0(h) of the corrective forces.
        strut: (6, n) `StrutConstants`.
        inertia: (n, n) H, 1/kg.
        point: (n,) h, 1/kg.
        shaker: (4,) `ShakerConstants`.
        stop: (3,) `StopConstants`.
        theta: () fraction of a fine step.
    """

    step: Array
    push: Array
    chain: Array
    voltage: Array
    force: Array
    strut: Array
    inertia: Array
    point: Array
    shaker: Array
    stop: Array
    theta: Array


class Design(NamedTuple):
    """The constants of one rig inside the kernel: `DesignArrays` with their rows named, without theta."""

    step: Any
    push: Any
    chain: Any
    voltage: Any
    force: Any
    strut: Any
    inertia: Any
    point: Any
    shaker: Any
    stop: Any


@njit(forceinline=True)
def named_design(step, push, chain, voltage, force, strut, inertia, point, shaker, stop):
    """Name the rows of `DesignArrays`. What is read most is copied, because the compiler knows that a copy is dense."""
    rows = strut.copy()
    return Design(
        step=step.copy(),
        push=push,
        chain=chain.copy(),
        voltage=VoltageColumns(voltage[0], voltage[1], voltage[2], voltage[3]),
        force=force,
        strut=StrutConstants(rows[0], rows[1], rows[2], rows[3], rows[4], rows[5]),
        inertia=inertia.copy(),
        point=point,
        shaker=ShakerConstants(shaker[0], shaker[1], shaker[2], shaker[3]),
        stop=StopConstants(stop[0], stop[1], stop[2]),
    )
