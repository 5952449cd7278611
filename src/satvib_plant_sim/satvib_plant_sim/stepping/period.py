# SPDX-FileCopyrightText: 2026 The satvib authors
# SPDX-License-Identifier: Apache-2.0
"""One sample period of one rig: the only place where the plant moves.

Every fine step is exact for the linear rig (`discretize`), with the voltages of `hold`; `fine_step` has its parts.
"""

import numpy as np
from satvib_common.kernels.compile import kernel
from satvib_common.kernels.deferred import njit

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


@njit
def _load_voltages(line, design, n):
    """Put what the voltages add per step, and per step index, into their two columns of `design.step`."""
    state = 3 * n + 2 * design.feet.shape[1]
    columns, driven = design.voltage, design.step[state : state + 2]
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
def _drive(drive, disturbance, b, j):
    """Set what drives fine step j from outside, b directions of the base."""
    drive[DriveSlot.ONE] = 1.0
    drive[DriveSlot.STEP] = j
    for m in range(b):
        drive[DriveSlot.BASE + m] = disturbance[m, j]
        drive[DriveSlot.BASE + b + m] = disturbance[m, j + 1]


@njit
def _push_payload(y, push, disturbance, b, j):
    """Add what the forces on the payload do in fine step j; their rows follow the b rows of the base."""
    for m in range(push.shape[0]):
        add_columns(y, push[m], disturbance[b + m, j : j + 2])


@njit
def _divide(y, volts, design):
    """Add what a voltage does that changes at theta within the step; its new line counts from the next step on."""
    add_columns(y, design.voltage.late_level, volts.change.level)
    add_columns(y, design.voltage.late_slope, volts.change.slope)
    _load_voltages(volts.line, design, volts.command.shape[0])


@njit
def _record_plates(x, design, disturbance, truth, j, load):
    """Record the accelerations of both plates along the struts at fine step j, with the struts' forces `load`."""
    feet, shaker, lower = design.feet, design.shaker, truth.lower
    plate, plate_rate = x.state.plate, x.state.plate_rate
    n, b = feet.shape
    if disturbance.shape[0] > b:
        for m in range(design.point.shape[0]):
            for i in range(n):
                truth.upper[i, j] += design.point[m, i] * disturbance[b + m, j]
    for m in range(b):
        if shaker.rigid > 0.0:
            moved = disturbance[m, j]
        else:
            total = 0.0
            for i in range(n):
                total += feet[i, m] * load.total[i]
            suspended = shaker.stiffness * plate[m] + shaker.damping * plate_rate[m]
            moved = -(total * design.plate[m]) - suspended
        for i in range(lower.shape[0]):
            along = feet[i, m] * moved
            lower[i, j] = along if m == 0 else lower[i, j] + along


@kernel(
    'void(f8[:,:],f8[:,:,:],f8[:,:],f8[:,:,:],f8[:,:],f8[:,:],f8[:,:],f8[:,:],f8[:,:],f8[:],f8[:],'
    'f8[:],f8,f8[:],f8[:,:],f8,f8[:,:],f8[:,:],f8[:],f8[:,:],f8[:,:],f8[:],f8[:],f8[:],f8[:])',
    '(c,r),(p,e,r),(q,q),(w,n,r),(n,r),(k,n),(n,n),(p,n),(n,b),(b),(s),(s),(),'
    '(n),(n,e),(),(d,f),(n,l),(r),(n,g),(o,g)->(n),(n),(n),(n)',
    writable=('ramp', 'state', 'upper', 'lower'),
)
def advance_period(
    step, push, chain, voltage, force, strut, inertia, point, feet, plate, shaker, stop, theta,
    command, event, linear, disturbance, ramp, state, upper, lower,
    stroke, stroke_peak, force_peak, current,
):  # fmt: skip
    """Advance one period; the first thirteen arguments are `DesignArrays`.

    Args:
        command, event: (n) V, and (n, 2) when they take effect (`EventSlot`).
        linear: 1 for linear hold.
        disturbance: (d, n_fine + 1) what shakes the rig: b rows of the base (acceleration, m/s^2 and rad/s^2), then p
            of the payload (N and N m), which may be missing.
        ramp, state: (n, 4) `RampSlot`, (R) `Row`; both change in place.
        upper, lower: (n, n_fine), (l, n_fine) true accelerations along the struts, m/s^2, filled.
        stroke, current: (n) results, m and A at the start.
        stroke_peak, force_peak: (n) results, m and N, the largest magnitudes; the force is the coil's.
    """
    n, stages, n_fine, b = strut.shape[1], chain.shape[0], lower.shape[1], feet.shape[1]
    design = named_design(
        step, push, chain, voltage, force, strut, inertia, point, feet, plate, shaker, stop
    )
    # the machine code of `vector_step` is for struts on a circle
    circle = b == 1
    x, y = row_of(state.copy(), n, b), row_of(np.zeros(state.shape[0]), n, b)
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
        _drive(drive, disturbance, b, j)
        if circle and n == 3 and stages == 2:
            step_3_2(columns, own, now, later)
        elif circle and n == 3 and stages == 3:
            step_3_3(columns, own, now, later)
        elif circle and n == 3 and stages == 5:
            step_3_5(columns, own, now, later)
        elif circle and n == 1 and stages == 2:
            step_1_2(columns, own, now, later)
        elif circle and n == 1 and stages == 3:
            step_1_3(columns, own, now, later)
        elif circle and n == 1 and stages == 5:
            step_1_5(columns, own, now, later)
        else:
            any_step(columns, own, now, later, 3 * n + 2 * b, 2 + 2 * b)
        if disturbance.shape[0] > b:
            _push_payload(later, design.push, disturbance, b, j)
        if divided:
            _divide(later, volts, design)
        if strut_forces(x, y, struts, load, n):
            correct(x, y, design, load)
        record_step(y, masses, load, truth, j, n)
        _record_plates(x, design, disturbance, truth, j, load)
        for r in range(state.shape[0]):
            now[r] = later[r]
    if upcoming == n_fine:
        change_lines(volts, n_fine, 0.0)
    end_period(volts)
    state[:] = now
