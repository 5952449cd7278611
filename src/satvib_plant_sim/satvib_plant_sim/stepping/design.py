# SPDX-FileCopyrightText: 2026 The satvib authors
# SPDX-License-Identifier: Apache-2.0
"""What a fine step works on: the layout of a row, and the constants of one rig.

A row (R numbers) begins with the slots that drive everything: the state of mechanics and coils (3n + 2b), then
`DriveSlot` with b numbers for the base at the start of the step and b at its end, then unused ones up to a multiple of
four, at least sixteen. The sensor chains follow, stage by stage, with one lane each for the n upper sensors and for the
lower ones, up to a multiple of four. Under struts on a circle the lower sensors have one lane for all of them: there
the lower plate moves along z alone.
"""

from enum import IntEnum
from typing import Any, NamedTuple

from satvib_common.arrays import Array
from satvib_common.kernels.deferred import njit

from satvib_plant_sim.physics.state import Size, compiled_state_of, lower_readings, state_size

WIDTH = 4  # numbers that one instruction works on


def _whole(count: int) -> int:
    return -(-count // WIDTH) * WIDTH


class Layout(NamedTuple):
    """Where a row's parts begin and end.

    Attributes:
        state: numbers of the state.
        inputs: numbers of `DriveSlot` behind it.
        driving: slots before the sensor chains.
        lanes: sensor chains, with the unused ones.
    """

    state: int
    inputs: int
    driving: int
    lanes: int

    def rows(self, stages: int) -> int:
        """Numbers of a row with sensor chains of some stages."""
        return self.driving + self.lanes * stages


def layout_of(size: Size) -> Layout:
    """Give the layout of a rig's rows."""
    state, inputs = state_size(size), 2 + 2 * size.plate
    return Layout(
        state=state,
        inputs=inputs,
        driving=max(_whole(state + inputs), 16),
        lanes=_whole(size.struts + lower_readings(size)),
    )


class DriveSlot(IntEnum):
    """What drives a fine step from outside; these slots follow the state."""

    ONE = 0  # 1: its column holds what the voltages add in each step
    STEP = 1  # index of the fine step: its column holds what the voltages add per index
    BASE = 2  # base acceleration (b) at the start of the step, m/s^2, rad/s^2; then at its end


class Row(NamedTuple):
    """One row, and views of its parts.

    Attributes:
        whole: (R).
        state: `State`.
        drive: (2 + 2b) `DriveSlot`.
    """

    whole: Any
    state: Any
    drive: Any


@njit
def row_of(whole, n, b):
    """Give the views of a row (R) for n struts and b directions of the lower plate."""
    state = 3 * n + 2 * b
    return Row(
        whole=whole,
        state=compiled_state_of(whole, n, b),
        drive=whole[state : state + 2 + 2 * b],
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
        step: (d, R) the columns that multiply the driving slots; the kernel fills those of the voltages.
        push: (p, 2, R) the same for the forces on the payload at both ends of a step.
        chain: (c, c) within a chain of c stages.
        voltage: (4, n, R) `VoltageColumns`.
        force: (n, R) G0(h) of the corrective forces.
        strut: (6, n) `StrutConstants`.
        inertia: (n, n) H, 1/kg.
        point: (p, n) h, 1/kg and 1/(kg m).
        feet: (n, b) P, from the lower plate's motions to the feet.
        plate: (b,) 1/m_l, 1/kg and 1/(kg m^2).
        shaker: (3,) `ShakerConstants`.
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
    feet: Array
    plate: Array
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
    feet: Any
    plate: Any
    shaker: Any
    stop: Any


@njit(forceinline=True)
def named_design(
    step, push, chain, voltage, force, strut, inertia, point, feet, plate, shaker, stop
):
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
        feet=feet.copy(),
        plate=plate,
        shaker=ShakerConstants(shaker[0], shaker[1], shaker[2]),
        stop=StopConstants(stop[0], stop[1], stop[2]),
    )
