# SPDX-FileCopyrightText: 2026 The satvib authors
# SPDX-License-Identifier: Apache-2.0
"""The parts of one fine step: the linear rig, the forces, and the corrections where something is not linear.

Linear: columns (16) times rows (16 + 4 stages). For the usual filters, and for one and for three struts,
`vector_step` has the machine code, which takes a third of the time; the bits are the same with and without.

Corrections are constant over the step. The coil's peak force F_max lowers the force constant to F_max / |i| while it is
reached, for force and back-EMF alike, so that the coil never feeds energy:

    F += (k_eff - k) i,   V += (k - k_eff) s'   (voltage drive).

The stops are those of `contact`.
"""

from typing import Any

from numba import njit

from satvib_plant_sim.physics.contact import solve_stops
from satvib_plant_sim.stepping.discretize import INPUTS, LANES
from satvib_plant_sim.stepping.vector_step import fma, vector_step


@njit
def any_step(step, chain, x, y, size):
    """Make one fine step from x to y: step^T x[:16], plus the sensor chains' own dynamics; `size` is 3n + 2."""
    for r in range(step.shape[1]):
        total = step[size, r] * x[size]
        for c in range(size + 1, size + 4):
            total = fma(step[c, r], x[c], total)
        for c in range(size):
            total = fma(step[c, r], x[c], total)
        y[r] = total
    for p in range(chain.shape[0]):
        for q in range(chain.shape[0]):
            for lane in range(LANES):
                r = INPUTS + LANES * p + lane
                y[r] = fma(chain[p, q], x[INPUTS + LANES * q + lane], y[r])


def _forces(n: int) -> Any:
    """Make the function that gives the strut forces of n struts."""

    @njit
    def forces(x, y, strut, pull, f):
        """Fill the coils' pull and the struts' force f (n) at the start of a step; True when it needs correcting."""
        active = False
        for i in range(n):
            pull[i] = strut[2, i] * x[2 * n + i]
            f[i] = (pull[i] - strut[0, i] * x[i]) - strut[1, i] * x[n + i]
            active |= abs(pull[i]) > strut[4, i]
            active |= abs(x[i]) > strut[3, i]
            active |= abs(y[i]) > strut[3, i]
        return active

    return forces


def _record(n: int) -> Any:
    """Make the function that keeps what n struts did in a step."""

    @njit
    def record(y, inertia, pull, f, peak, upper, j):
        """Keep the peaks of stroke and pull (2, n) and the accelerations of column j; give the sum of the forces."""
        total = 0.0
        for i in range(n):
            total += f[i]
            peak[0, i] = max(peak[0, i], abs(y[i]))
            peak[1, i] = max(peak[1, i], abs(pull[i]))
            a = 0.0
            for k in range(n):
                a += inertia[i, k] * f[k]
            upper[i, j] = a
        return total

    return record


step_1_2, step_1_3, step_1_5 = vector_step(1, 2), vector_step(1, 3), vector_step(1, 5)
step_3_2, step_3_3, step_3_5 = vector_step(3, 2), vector_step(3, 3), vector_step(3, 5)
forces_1, forces_3 = _forces(1), _forces(3)
record_1, record_3 = _record(1), _record(3)


@njit
def add_rows(y, gains, amounts):
    """Add the sum over i of gains[i] amounts[i] to y."""
    for i in range(amounts.shape[0]):
        for r in range(y.shape[0]):
            y[r] += gains[i, r] * amounts[i]


@njit
def correct(x, y, strut, voltage, force, stop, pull, f):
    """Correct a step from x to y for coils at their peak force and struts at their stops.

    Args:
        x, y: states at both ends; y changes.
        strut: (6, n) of `Discrete`.
        voltage, force: (n, R) what a volt, and a newton, held over the step adds to y.
        stop: (3,) stiffness, damping, h.
        pull, f: (n) forces of `forces`; both change.
    """
    n = strut.shape[1]
    stops = pull * 0.0
    free = stops.copy()
    for i in range(n):
        if abs(pull[i]) > strut[4, i]:
            limited = strut[4, i] if pull[i] > 0.0 else -strut[4, i]
            back = (strut[2, i] - limited / x[2 * n + i]) * x[n + i] * strut[5, i]
            excess = limited - pull[i]
            for r in range(y.shape[0]):
                y[r] += voltage[i, r] * back + force[i, r] * excess
            pull[i] = limited
            f[i] += excess
    contact = False
    for i in range(n):
        free[i] = y[i]
        contact |= abs(x[i]) > strut[3, i] or abs(y[i]) > strut[3, i]
    if contact:
        solve_stops(x, free, force, strut, stop[0], stop[1] / stop[2], stops)
        add_rows(y, force, stops)
        for i in range(n):
            f[i] += stops[i]
