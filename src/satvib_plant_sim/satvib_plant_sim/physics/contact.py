# SPDX-FileCopyrightText: 2026 The satvib authors
# SPDX-License-Identifier: Apache-2.0
"""Stroke stops that cannot create energy.

A stop is a spring k_c and a damper c_c that act while |s| is above the limit l. Over one fine step its force is
constant, so the work on the strut is exactly F (s1 - s0), whatever else moves. With the penetration p = max(|s| - l, 0)
and the stored energy U = k_c p^2 / 2, the force

    F = -(U(s1) - U(s0)) / (s1 - s0) - c_c (p1 - p0) / h  (times the side),   never pulling

gives F (s1 - s0) + U1 - U0 <= 0: what the mechanics gain the spring has lost (a discrete gradient: Gonzalez 1996,
J. Nonlinear Sci. 6, 449). s1 = s1_free + G F depends on the force; F(s1) falls monotonically, so each strut has one
solution (bisection), and a few Gauss-Seidel sweeps settle the weak coupling of the struts.
"""

from numba import njit

SWEEPS = 8
BISECTIONS = 60


@njit
def stop_force(s0, s1, limit, stiffness, damping_per_step):
    """Force (N) of both stops of a strut that goes from s0 to s1 (m) in one step."""
    total = 0.0
    for side in (1.0, -1.0):
        p0 = side * s0 - limit
        p1 = side * s1 - limit
        p0 = max(0.0, p0)
        p1 = max(0.0, p1)
        if p0 > 0.0 or p1 > 0.0:
            move = side * (s1 - s0)
            # (p1 - p0) / (s1 - s0) is 1 deep in contact, also when nothing moves
            share = 1.0 if p0 > 0.0 and p1 > 0.0 else (p1 - p0) / move
            push = 0.5 * stiffness * (p0 + p1) * share + damping_per_step * (p1 - p0)
            if push > 0.0:
                total -= side * push
    return total


@njit
def solve_stops(x, free, compliance, strut, stiffness, damping_per_step, force):
    """Find the forces (n) that fit the strokes they lead to.

    Args:
        x, free: strokes (the first n) at the start of the step, and at its end without stops.
        compliance: (n, rows) stroke at the end of the step in row j per force on strut i.
        strut: (6, n) of `Discrete`; row 3 is the stroke limit, m.
        stiffness, damping_per_step: N/m; the damping is c_c / h.
        force: (n) result.
    """
    n = force.shape[0]
    force[:] = 0.0
    for _ in range(SWEEPS):
        for i in range(n):
            rest = free[i]
            for j in range(n):
                if j != i:
                    rest += compliance[j, i] * force[j]
            own = compliance[i, i]
            limit = strut[3, i]
            # the root lies between the end without this force and the end with all the force that end asks for
            low = rest
            high = rest + own * stop_force(x[i], rest, limit, stiffness, damping_per_step)
            if low > high:
                low, high = high, low
            for _ in range(BISECTIONS):
                mid = 0.5 * (low + high)
                push = stop_force(x[i], mid, limit, stiffness, damping_per_step)
                if mid - rest - own * push > 0.0:
                    high = mid
                else:
                    low = mid
            force[i] = stop_force(x[i], 0.5 * (low + high), limit, stiffness, damping_per_step)
