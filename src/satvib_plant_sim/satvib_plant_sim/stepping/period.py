# SPDX-FileCopyrightText: 2026 The satvib authors
# SPDX-License-Identifier: Apache-2.0
"""One sample period of one rig: the only place where the plant moves.

Every fine step is exact for the linear rig (`discretize`), with the voltages of `hold`; `fine_step` has its parts.
"""

import numpy as np
from numba import njit
from satvib_common.kernels.compile import kernel

from satvib_plant_sim.stepping.fine_step import (
    add_rows,
    any_step,
    correct,
    forces_1,
    forces_3,
    record_1,
    record_3,
    step_1_2,
    step_1_3,
    step_1_5,
    step_3_2,
    step_3_3,
    step_3_5,
)
from satvib_plant_sim.stepping.hold import begin_lines, next_event, turn


@njit
def _load_voltages(line, hold, step, slot):
    """Put what the voltages add per step (constant, and per step index) into two columns of `step`."""
    for r in range(step.shape[1]):
        constant = 0.0
        growing = 0.0
        for i in range(line.shape[1]):
            constant += hold[0, i, r] * line[0, i] + hold[1, i, r] * line[1, i]
            growing += hold[0, i, r] * line[1, i]
        step[slot, r] = constant
        step[slot + 1, r] = growing


@kernel(
    'void(f8[:,:],f8[:,:],f8[:,:],f8[:,:,:],f8[:,:],f8[:,:],f8[:,:],f8[:],f8[:],f8[:],f8,'
    'f8[:],f8[:,:],f8,f8[:,:],f8[:,:],f8[:],f8[:,:],f8[:],f8[:,:])',
    '(c,r),(e,r),(q,q),(w,n,r),(n,r),(k,n),(n,n),(n),(l),(s),(),'
    '(n),(n,e),(),(d,f),(n,l),(r),(n,g),(g)->(l,n)',
    writable=('ramp', 'state', 'upper', 'lower'),
)
def advance_period(
    columns,
    push,
    chain,
    hold,
    force,
    strut,
    inertia,
    point,
    shaker,
    stop,
    theta,
    command,
    event,
    linear,
    disturbance,
    ramp,
    state,
    upper,
    lower,
    summary,
):
    """Advance one period; the arrays of the rig are those of `Discrete`.

    Args:
        command, event: (n) V and (n, 2) when they take effect: fine step (n_fine: at the very end), flag of theta.
        linear: 1 for linear hold.
        disturbance: (d, n_fine + 1) base acceleration, m/s^2, and, if d is 2, payload force, N.
        ramp, state: (n, 4) of `hold`, (R) of `discretize`; both change in place.
        upper, lower: (n, n_fine), (n_fine) true accelerations, m/s^2, filled.
        summary: (4, n) result: stroke at the start, its largest magnitude, the coil's largest force, the
            current at the start.
    """
    n = strut.shape[1]
    n_fine = lower.shape[0]
    rows = state.shape[0]
    stages = chain.shape[0]
    size = 3 * n + 2
    channels = disturbance.shape[0]
    # copies lie densely, which the compiler needs to know
    step = columns.copy()
    own = chain.copy()
    springs = strut.copy()
    masses = inertia.copy()
    x = state.copy()
    y = np.zeros(rows)
    line = np.empty((2, n))
    change = np.zeros((2, n))
    pull = np.empty(n)
    f = np.empty(n)
    peak = np.zeros((2, n))

    begin_lines(ramp, n_fine, theta, line)
    _load_voltages(line, hold, step, size)
    upcoming = next_event(ramp, event, n_fine, -1.0)
    for i in range(n):
        summary[0, i] = x[i]
        summary[3, i] = x[2 * n + i]
        peak[0, i] = abs(x[i])

    for j in range(n_fine):
        divided = False
        if upcoming == j:
            if turn(ramp, line, event, command, linear, n_fine, theta, j, 0.0, change):
                _load_voltages(line, hold, step, size)
            divided = turn(ramp, line, event, command, linear, n_fine, theta, j, 1.0, change)
            upcoming = next_event(ramp, event, n_fine, float(j))
        x[size] = 1.0
        x[size + 1] = j
        x[size + 2] = disturbance[0, j]
        x[size + 3] = disturbance[0, j + 1]
        if n == 3 and stages == 2:
            step_3_2(step, own, x, y)
        elif n == 3 and stages == 3:
            step_3_3(step, own, x, y)
        elif n == 3 and stages == 5:
            step_3_5(step, own, x, y)
        elif n == 1 and stages == 2:
            step_1_2(step, own, x, y)
        elif n == 1 and stages == 3:
            step_1_3(step, own, x, y)
        elif n == 1 and stages == 5:
            step_1_5(step, own, x, y)
        else:
            any_step(step, own, x, y, size)
        if channels > 1:
            add_rows(y, push, disturbance[1, j : j + 2])
        if divided:
            add_rows(y, hold[2], change[0])
            add_rows(y, hold[3], change[1])
            _load_voltages(line, hold, step, size)

        if forces_3(x, y, springs, pull, f) if n == 3 else forces_1(x, y, springs, pull, f):
            correct(x, y, springs, hold[0], force, stop, pull, f)
        if n == 3:
            reaction = record_3(y, masses, pull, f, peak, upper, j)
        else:
            reaction = record_1(y, masses, pull, f, peak, upper, j)
        if channels > 1:
            for i in range(n):
                upper[i, j] += point[i] * disturbance[1, j]
        if shaker[3] > 0.0:
            lower[j] = disturbance[0, j]
        else:
            suspended = shaker[0] * x[3 * n] + shaker[1] * x[3 * n + 1]
            lower[j] = -(reaction * shaker[2]) - suspended
        x, y = y, x

    if upcoming == n_fine:
        turn(ramp, line, event, command, linear, n_fine, theta, n_fine, 0.0, change)
    for i in range(n):
        ramp[i, 2] -= n_fine
        summary[1, i] = peak[0, i]
        summary[2, i] = peak[1, i]
    state[:] = x
