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

from typing import Any, NamedTuple

from satvib_common.kernels.deferred import njit

SWEEPS = 8
BISECTIONS = 60


class Stops(NamedTuple):
    """The stops of n struts.

    Attributes:
        limit: (n) m, stroke at which they begin.
        stiffness, damping_per_step: N/m; the damping is c_c / h.
    """

    limit: Any
    stiffness: Any
    damping_per_step: Any


@njit
def stop_force(s0, s1, stops, i):
    """Force (N) of both stops of strut i that goes from s0 to s1 (m) in one step."""
    total = 0.0
    for side in (1.0, -1.0):
        p0 = max(0.0, side * s0 - stops.limit[i])
        p1 = max(0.0, side * s1 - stops.limit[i])
        if p0 > 0.0 or p1 > 0.0:
            move = side * (s1 - s0)
            # (p1 - p0) / (s1 - s0) is 1 deep in contact, also when nothing moves
            share = 1.0 if p0 > 0.0 and p1 > 0.0 else (p1 - p0) / move
            spring = 0.5 * stops.stiffness * (p0 + p1) * share
            push = spring + stops.damping_per_step * (p1 - p0)
            if push > 0.0:
                total -= side * push
    return total


@njit
def solve_stops(start, free, compliance, stops, force):
    """Find the forces (n) that fit the strokes they lead to.

    Args:
        start, free: (n) m, strokes at the start of the step, and at its end without stops.
        compliance: (n, rows) stroke at the end of the step in row j per force on strut i.
        stops: `Stops`.
        force: (n) N, result.
    """
    n = force.shape[0]
    force[:] = 0.0
    for _ in range(SWEEPS):
        for i in range(n):
            rest = free[i]
            for j in range(n):
                if j != i:
                    rest += compliance[j, i] * force[j]
            force[i] = _solve_stop(start[i], rest, compliance[i, i], stops, i)


@njit
def _solve_stop(start, rest, own, stops, i):
    """Find the force of strut i by bisection; `rest` (m) is where it ends without this force."""
    # the solution lies between the end without this force and the end with the force that belongs to this end
    low = rest
    high = rest + own * stop_force(start, rest, stops, i)
    if low > high:
        low, high = high, low
    for _ in range(BISECTIONS):
        mid = 0.5 * (low + high)
        if mid - rest - own * stop_force(start, mid, stops, i) > 0.0:
            high = mid
        else:
            low = mid
    return stop_force(start, 0.5 * (low + high), stops, i)
