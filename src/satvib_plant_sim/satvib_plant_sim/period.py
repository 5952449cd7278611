# SPDX-FileCopyrightText: 2026 The satvib authors
# SPDX-License-Identifier: Apache-2.0
"""One sample period of one rig: the only place where the plant moves.

Every fine step is exact for the linear rig (`discretize`), with the voltages of `hold`. What is not linear comes as
corrections that are constant over a step and only where they are active: the force constant that falls when the coil's
peak force is reached (force and back-EMF alike, so that the coil never feeds energy), and the stops of `contact`.
"""

import numpy as np
from numba import njit
from satvib_common.kernel import kernel

from satvib_plant_sim.contact import solve_stops
from satvib_plant_sim.hold import begin_lines, next_event, turn


@njit(cache=True)
def _load_voltages(line, hold, step, slot):  # type: ignore[no-untyped-def]  # noqa: ANN001, ANN202
    """Put what the voltages add per step (constant, and per step index) into two columns of `step`."""
    for r in range(step.shape[1]):
        constant = 0.0
        growing = 0.0
        for i in range(line.shape[1]):
            constant += hold[0, i, r] * line[0, i] + hold[1, i, r] * line[1, i]
            growing += hold[0, i, r] * line[1, i]
        step[slot, r] = constant
        step[slot + 1, r] = growing


@njit(cache=True)
def _linear_step(step, chain, x, v, y):  # type: ignore[no-untyped-def]  # noqa: ANN001, ANN202
    """Make one fine step: step^T v, plus the sensor chains' own dynamics, into y."""
    rows = step.shape[1]
    stages = chain.shape[0]
    base = rows - 4 * stages
    for r in range(rows):
        y[r] = 0.0
    for b in range(0, step.shape[0], 4):
        v0 = v[b]
        v1 = v[b + 1]
        v2 = v[b + 2]
        v3 = v[b + 3]
        for r in range(rows):
            y[r] = (((y[r] + step[b, r] * v0) + step[b + 1, r] * v1) + step[b + 2, r] * v2) + step[
                b + 3, r
            ] * v3
    for p in range(stages):
        for q in range(stages):
            c = chain[p, q]
            for lane in range(4):
                y[base + 4 * p + lane] += c * x[base + 4 * q + lane]


@njit(cache=True)
def _saturate_coil(x, strut, hold, step_rows, force, y):  # type: ignore[no-untyped-def]  # noqa: ANN001, ANN202
    """Where the coil would pass its peak force, take the excess off force and back-EMF for this step."""
    n = strut.shape[1]
    for i in range(n):
        full = strut[2, i] * x[2 * n + i]
        force[i] = 0.0
        if abs(full) > strut[4, i]:
            limited = strut[4, i] if full > 0.0 else -strut[4, i]
            force[i] = limited - full
            back = (strut[2, i] - limited / x[2 * n + i]) * x[n + i] * strut[5, i]
            for r in range(step_rows):
                y[r] += hold[0, i, r] * back


@kernel(
    'void(f8[:,:],f8[:,:],f8[:,:,:],f8[:,:],f8[:,:],f8[:,:],f8[:],f8[:],f8[:],f8,'
    'f8[:],f8[:,:],f8,f8[:,:],f8[:,:],f8[:],f8[:,:],f8[:],f8[:,:])',
    '(c,r),(q,q),(w,n,r),(n,r),(k,n),(n,n),(n),(l),(s),(),'
    '(n),(n,e),(),(d,f),(n,l),(r),(n,g),(g)->(l,n)',
    writable=('ramp', 'state', 'upper', 'lower'),
)
def advance_period(  # type: ignore[no-untyped-def]  # noqa: ANN201
    columns,  # noqa: ANN001
    chain,  # noqa: ANN001
    hold,  # noqa: ANN001
    force,  # noqa: ANN001
    strut,  # noqa: ANN001
    inertia,  # noqa: ANN001
    point,  # noqa: ANN001
    shaker,  # noqa: ANN001
    stop,  # noqa: ANN001
    theta,  # noqa: ANN001
    command,  # noqa: ANN001
    event,  # noqa: ANN001
    linear,  # noqa: ANN001
    disturbance,  # noqa: ANN001
    ramp,  # noqa: ANN001
    state,  # noqa: ANN001
    upper,  # noqa: ANN001
    lower,  # noqa: ANN001
    summary,  # noqa: ANN001
):
    """Advance one period; the arrays of the rig are those of `Discrete`.

    Args:
        command, event: (n) V and (n, 2) when they take effect: fine step (n_fine: at the very end), flag of theta.
        linear: 1 for linear hold.
        disturbance: (d, n_fine + 1) base acceleration, m/s^2, and, if d is 2, payload force, N.
        ramp, state: (n, 4) of `hold`, (R) of `discretize`; both change in place.
        upper, lower: (n, n_fine), (n_fine) true accelerations, m/s^2, filled.
        summary: (4, n) result: stroke at the start, its largest magnitude, the largest force of the coil, the current
            at the start.
    """
    n = strut.shape[1]
    n_fine = lower.shape[0]
    rows = state.shape[0]
    size = 3 * n + 2
    channels = disturbance.shape[0]
    step = np.empty(columns.shape)
    step[:, :] = columns
    x = np.empty(rows)
    x[:] = state
    y = np.empty(rows)
    v = np.zeros(columns.shape[0])
    line = np.empty((2, n))
    change = np.zeros((2, n))
    coil = np.zeros(n)
    stops = np.zeros(n)
    f = np.empty(n)

    begin_lines(ramp, n_fine, theta, line)
    _load_voltages(line, hold, step, size)
    upcoming = next_event(ramp, event, n_fine, -1.0)
    for i in range(n):
        summary[0, i] = x[i]
        summary[1, i] = abs(x[i])
        summary[2, i] = 0.0
        summary[3, i] = x[2 * n + i]

    for j in range(n_fine):
        divided = False
        if upcoming == j:
            if turn(ramp, line, event, command, linear, n_fine, theta, j, 0.0, change):
                _load_voltages(line, hold, step, size)
            divided = turn(ramp, line, event, command, linear, n_fine, theta, j, 1.0, change)
            upcoming = next_event(ramp, event, n_fine, float(j))
        for r in range(size):
            v[r] = x[r]
        v[size] = 1.0
        v[size + 1] = j
        v[size + 2] = disturbance[0, j]
        v[size + 3] = disturbance[0, j + 1]
        if channels > 1:
            v[size + 4] = disturbance[1, j]
            v[size + 5] = disturbance[1, j + 1]
        _linear_step(step, chain, x, v, y)
        if divided:
            for i in range(n):
                for r in range(rows):
                    y[r] += hold[2, i, r] * change[0, i] + hold[3, i, r] * change[1, i]
            _load_voltages(line, hold, step, size)

        saturated = False
        contact = False
        for i in range(n):
            saturated = saturated or abs(strut[2, i] * x[2 * n + i]) > strut[4, i]
            contact = contact or abs(x[i]) > strut[3, i] or abs(y[i]) > strut[3, i]
            coil[i] = 0.0
            stops[i] = 0.0
        if saturated:
            _saturate_coil(x, strut, hold, rows, coil, y)
            for i in range(n):
                for r in range(rows):
                    y[r] += force[i, r] * coil[i]
                contact = contact or abs(y[i]) > strut[3, i]
        if contact:
            solve_stops(x[:n], y[:n].copy(), force, strut[3], stop[0], stop[1] / stop[2], stops)
            for i in range(n):
                for r in range(rows):
                    y[r] += force[i, r] * stops[i]

        reaction = 0.0
        for i in range(n):
            pull = strut[2, i] * x[2 * n + i] + coil[i]
            f[i] = ((pull - strut[0, i] * x[i]) - strut[1, i] * x[n + i]) + stops[i]
            reaction += f[i]
            summary[2, i] = max(summary[2, i], abs(pull))
            summary[1, i] = max(summary[1, i], abs(y[i]))
        for i in range(n):
            a = 0.0
            for k in range(n):
                a += inertia[i, k] * f[k]
            if channels > 1:
                a += point[i] * disturbance[1, j]
            upper[i, j] = a
        if shaker[3] > 0.0:
            lower[j] = disturbance[0, j]
        else:
            suspended = shaker[0] * x[3 * n] + shaker[1] * x[3 * n + 1]
            lower[j] = -(reaction * shaker[2]) - suspended
        for r in range(rows):
            x[r] = y[r]

    if upcoming == n_fine:
        turn(ramp, line, event, command, linear, n_fine, theta, n_fine, 0.0, change)
    for i in range(n):
        ramp[i, 2] -= n_fine
    state[:] = x
