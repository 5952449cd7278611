# SPDX-FileCopyrightText: 2026 The satvib authors
# SPDX-License-Identifier: Apache-2.0
"""One sample period of one rig: the only place where the plant moves.

Every fine step is exact for the linear rig (`discretize`), with the voltages of `hold`; `fine_step` has its parts.
"""

from enum import IntEnum

import numpy as np
from satvib_common.kernels.compile import kernel
from satvib_common.kernels.deferred import njit

from satvib_plant_sim.physics.state import PlateSlot
from satvib_plant_sim.stepping.design import DriveSlot, named_design, row_of
from satvib_plant_sim.stepping.fine_step import (
    StrutForces,
    Truth,
    add_columns,
    any_step,
    correct,
    record_step,
    step_1_2,
    step_1_3,
    step_1_5,
    step_3_2,
    step_3_3,
    step_3_5,
    strut_forces,
)
from satvib_plant_sim.stepping.hold import (
    Line,
    Voltages,
    begin_period,
    change_lines,
    end_period,
    next_event,
)


class DisturbanceRow(IntEnum):
    """What shakes the rig."""

    BASE = 0  # acceleration of the base, m/s^2
    PAYLOAD = 1  # force on the payload, N; the row may be missing


@njit
def _load_voltages(line, design, n):
    """Put what the voltages add per step, and per step index, into their two columns of `design.step`."""
    columns, driven = design.voltage, design.step[3 * n + 2 : 3 * n + 6]
    for r in range(design.step.shape[1]):
        constant = 0.0
        growing = 0.0
        for i in range(n):
            level, slope = line.level[i], line.slope[i]
            constant += columns.level[i, r] * level + columns.slope[i, r] * slope
            growing += columns.level[i, r] * slope
        driven[DriveSlot.ONE, r] = constant
        driven[DriveSlot.STEP, r] = growing


@njit
def _drive(drive, disturbance, j):
    """Set what drives fine step j from outside."""
    drive[DriveSlot.ONE] = 1.0
    drive[DriveSlot.STEP] = j
    drive[DriveSlot.BASE_START] = disturbance[DisturbanceRow.BASE, j]
    drive[DriveSlot.BASE_END] = disturbance[DisturbanceRow.BASE, j + 1]


@njit
def _push_payload(y, push, disturbance, j):
    """Add what the force on the payload does in fine step j."""
    add_columns(y, push, disturbance[DisturbanceRow.PAYLOAD, j : j + 2])


@njit
def _divide(y, volts, design):
    """Add what a voltage does that changes at theta within the step; its new line counts from the next step on."""
    add_columns(y, design.voltage.late_level, volts.change.level)
    add_columns(y, design.voltage.late_slope, volts.change.slope)
    _load_voltages(volts.line, design, volts.command.shape[0])


@njit
def _record_plates(x, design, disturbance, truth, j, total):
    """Record the accelerations of both plates at fine step j, where the struts' forces have the sum `total`."""
    if disturbance.shape[0] > DisturbanceRow.PAYLOAD:
        for i in range(design.point.shape[0]):
            truth.upper[i, j] += design.point[i] * disturbance[DisturbanceRow.PAYLOAD, j]
    shaker, plate = design.shaker, x.state.plate
    if shaker.rigid > 0.0:
        truth.lower[j] = disturbance[DisturbanceRow.BASE, j]
    else:
        suspended = (
            shaker.stiffness * plate[PlateSlot.POSITION] + shaker.damping * plate[PlateSlot.RATE]
        )
        truth.lower[j] = -(total * shaker.inverse_mass) - suspended


@kernel(
    'void(f8[:,:],f8[:,:],f8[:,:],f8[:,:,:],f8[:,:],f8[:,:],f8[:,:],f8[:],f8[:],f8[:],f8,'
    'f8[:],f8[:,:],f8,f8[:,:],f8[:,:],f8[:],f8[:,:],f8[:],f8[:],f8[:],f8[:],f8[:])',
    '(c,r),(e,r),(q,q),(w,n,r),(n,r),(k,n),(n,n),(n),(l),(s),(),'
    '(n),(n,e),(),(d,f),(n,l),(r),(n,g),(g)->(n),(n),(n),(n)',
    writable=('ramp', 'state', 'upper', 'lower'),
)
def advance_period(
    step, push, chain, voltage, force, strut, inertia, point, shaker, stop, theta,
    command, event, linear, disturbance, ramp, state, upper, lower,
    stroke, stroke_peak, force_peak, current,
):  # fmt: skip
    """Advance one period; the first eleven arguments are `DesignArrays`.

    Args:
        command, event: (n) V, and (n, 2) when they take effect (`EventSlot`).
        linear: 1 for linear hold.
        disturbance: (d, n_fine + 1) `DisturbanceRow`.
        ramp, state: (n, 4) `RampSlot`, (R) `Row`; both change in place.
        upper, lower: (n, n_fine), (n_fine) true accelerations, m/s^2, filled.
        stroke, current: (n) results, m and A at the start.
        stroke_peak, force_peak: (n) results, m and N, the largest magnitudes; the force is the coil's.
    """
    n, stages, n_fine = strut.shape[1], chain.shape[0], lower.shape[0]
    design = named_design(step, push, chain, voltage, force, strut, inertia, point, shaker, stop)
    x, y = row_of(state.copy(), n), row_of(np.zeros(state.shape[0]), n)
    load = StrutForces(pull=np.empty(n), total=np.empty(n))
    truth = Truth(upper=upper, lower=lower, stroke_peak=stroke_peak, force_peak=force_peak)
    volts = Voltages(
        ramp=ramp, line=Line(level=np.empty(n), slope=np.empty(n)),
        change=Line(level=np.zeros(n), slope=np.zeros(n)),
        command=command, event=event, n_fine=n_fine, theta=theta, linear=linear > 0.0,
    )  # fmt: skip
    # named once: each access to a part of a tuple in the loop would count references
    now, later, drive, columns, own = x.whole, y.whole, x.drive, design.step, design.chain
    struts, masses = design.strut, design.inertia
    for i in range(n):
        stroke[i], current[i] = x.state.stroke[i], x.state.current[i]
        stroke_peak[i], force_peak[i] = abs(stroke[i]), 0.0

    begin_period(volts)
    _load_voltages(volts.line, design, n)
    upcoming = next_event(volts, -1.0)
    for j in range(n_fine):
        divided = False
        if upcoming == j:
            if change_lines(volts, j, 0.0):
                _load_voltages(volts.line, design, n)
            divided = change_lines(volts, j, 1.0)
            upcoming = next_event(volts, float(j))
        _drive(drive, disturbance, j)
        if n == 3 and stages == 2:
            step_3_2(columns, own, now, later)
        elif n == 3 and stages == 3:
            step_3_3(columns, own, now, later)
        elif n == 3 and stages == 5:
            step_3_5(columns, own, now, later)
        elif n == 1 and stages == 2:
            step_1_2(columns, own, now, later)
        elif n == 1 and stages == 3:
            step_1_3(columns, own, now, later)
        elif n == 1 and stages == 5:
            step_1_5(columns, own, now, later)
        else:
            any_step(columns, own, now, later, 3 * n + 2)
        if disturbance.shape[0] > DisturbanceRow.PAYLOAD:
            _push_payload(later, design.push, disturbance, j)
        if divided:
            _divide(later, volts, design)
        if strut_forces(x, y, struts, load, n):
            correct(x, y, design, load)
        total = record_step(y, masses, load, truth, j, n)
        _record_plates(x, design, disturbance, truth, j, total)
        for r in range(state.shape[0]):
            now[r] = later[r]
    if upcoming == n_fine:
        change_lines(volts, n_fine, 0.0)
    end_period(volts)
    state[:] = now
