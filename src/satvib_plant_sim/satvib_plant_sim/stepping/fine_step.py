# SPDX-FileCopyrightText: 2026 The satvib authors
# SPDX-License-Identifier: Apache-2.0
"""The parts of one fine step from row x to row y: the linear rig, the forces, and the corrections.

Linear: columns times rows of `design`. For the usual filters, and for one and for three struts, `vector_step` has the
machine code, which takes a third of the time; the bits are the same with and without.

Corrections are needed where something is not linear; they are constant over the step. The coil's peak force F_max
lowers the force constant to F_max / |i| while it is reached, for force and back-EMF alike, so that the coil never feeds
energy:

    F += (k_eff - k) i,   V += (k - k_eff) s'   (voltage drive).

The stops are those of `contact`.
"""

from typing import Any, NamedTuple

import numpy as np
from satvib_common.kernels.deferred import njit

from satvib_plant_sim.physics.contact import Stops, solve_stops
from satvib_plant_sim.physics.state import Size
from satvib_plant_sim.stepping.design import Layout, layout_of
from satvib_plant_sim.stepping.vector_step import fma, vector_step


class StrutForces(NamedTuple):
    """Forces at the start of a step, (n) each, N: the coils' pull, and the total force of the strut."""

    pull: Any
    total: Any


class Truth(NamedTuple):
    """What is recorded of a period.

    Attributes:
        upper: (n, n_fine) m/s^2, acceleration of the upper plate at the struts.
        lower: (l, n_fine) m/s^2, of the lower plate along the struts, one row where all are the same.
        stroke_peak, force_peak: (n) m, N; largest magnitudes.
    """

    upper: Any
    lower: Any
    stroke_peak: Any
    force_peak: Any


@njit
def any_step(step, chain, x, y, size, inputs):
    """Make one linear step from x to y: step^T x[:d], plus the sensor chains' own dynamics.

    `size` is that of the state, `inputs` what follows it (`DriveSlot`). Rows are innermost, so that the compiler finds
    vectors; each row has its own sum, in the order of `vector_step.order`.
    """
    driving, rows = step.shape[0], step.shape[1]
    lanes = (rows - driving) // chain.shape[0]
    first = x[size]
    for r in range(rows):
        y[r] = step[size, r] * first
    for c in range(size + 1, size + inputs):
        now = x[c]
        for r in range(rows):
            y[r] = fma(step[c, r], now, y[r])
    for c in range(size):
        now = x[c]
        for r in range(rows):
            y[r] = fma(step[c, r], now, y[r])
    for p in range(chain.shape[0]):
        for q in range(chain.shape[0]):
            within = chain[p, q]
            for lane in range(lanes):
                r = driving + lanes * p + lane
                y[r] = fma(within, x[driving + lanes * q + lane], y[r])


_ONE: Layout = layout_of(Size(struts=1, plate=1, payload=1))
_THREE: Layout = layout_of(Size(struts=3, plate=1, payload=1))
step_1_2, step_1_3, step_1_5 = (vector_step(_ONE, stages) for stages in (2, 3, 5))
step_3_2, step_3_3, step_3_5 = (vector_step(_THREE, stages) for stages in (2, 3, 5))


def _forces(n: int) -> Any:
    """Make the function that gives the strut forces of n struts; 0 is any number."""

    @njit
    def forces(x, y, strut, load):
        """Fill `load` (`StrutForces`) at the start of a step; gives whether the step needs a correction."""
        active = False
        for i in range(n if n > 0 else load.pull.shape[0]):
            stroke = x.state.stroke[i]
            load.pull[i] = strut.force_constant[i] * x.state.current[i]
            spring = strut.stiffness[i] * stroke
            load.total[i] = (load.pull[i] - spring) - strut.damping[i] * x.state.rate[i]
            active |= abs(load.pull[i]) > strut.force_limit[i]
            active |= abs(stroke) > strut.stroke_limit[i]
            active |= abs(y.state.stroke[i]) > strut.stroke_limit[i]
        return active

    return forces


def _record(n: int) -> Any:
    """Make the function that records what n struts did in a step; 0 is any number."""

    @njit
    def record(y, inertia, load, truth, j):
        """Record the peaks, and the accelerations of the upper plate at fine step j."""
        struts = n if n > 0 else load.pull.shape[0]
        for i in range(struts):
            truth.stroke_peak[i] = max(truth.stroke_peak[i], abs(y.state.stroke[i]))
            truth.force_peak[i] = max(truth.force_peak[i], abs(load.pull[i]))
            a = 0.0
            for k in range(struts):
                a += inertia[i, k] * load.total[k]
            truth.upper[i, j] = a

    return record


_forces_1, _forces_3, _forces_any = _forces(1), _forces(3), _forces(0)
_record_1, _record_3, _record_any = _record(1), _record(3), _record(0)


@njit
def strut_forces(x, y, strut, load, n):
    """Fill the forces `load` at the start of a step; gives whether the step needs a correction."""
    if n == 3:
        return _forces_3(x, y, strut, load)
    if n == 1:
        return _forces_1(x, y, strut, load)
    return _forces_any(x, y, strut, load)


@njit
def record_step(y, inertia, load, truth, j, n):
    """Record the peaks, and the accelerations of the upper plate at fine step j."""
    if n == 3:
        _record_3(y, inertia, load, truth, j)
    elif n == 1:
        _record_1(y, inertia, load, truth, j)
    else:
        _record_any(y, inertia, load, truth, j)


@njit
def add_columns(y, columns, amounts):
    """Add the sum over i of columns[i] amounts[i] to y."""
    for i in range(amounts.shape[0]):
        for r in range(y.shape[0]):
            y[r] += columns[i, r] * amounts[i]


@njit
def correct(x, y, design, load):
    """Correct a step for coils at their peak force and struts at their stops; y and `load` change."""
    strut = design.strut
    _limit_coils(x, y, design, load)
    for i in range(load.pull.shape[0]):
        limit = strut.stroke_limit[i]
        if abs(x.state.stroke[i]) > limit or abs(y.state.stroke[i]) > limit:
            _stop_struts(x, y, design, load)
            return


@njit
def _limit_coils(x, y, design, load):
    """Lower the force constant of coils that pull more than their peak force."""
    strut = design.strut
    for i in range(load.pull.shape[0]):
        if abs(load.pull[i]) > strut.force_limit[i]:
            limited = strut.force_limit[i] if load.pull[i] > 0.0 else -strut.force_limit[i]
            constant = strut.force_constant[i] - limited / x.state.current[i]
            back = constant * x.state.rate[i] * strut.back_emf[i]
            excess = limited - load.pull[i]
            for r in range(y.whole.shape[0]):
                y.whole[r] += design.voltage.level[i, r] * back + design.force[i, r] * excess
            load.pull[i] = limited
            load.total[i] += excess


@njit
def _stop_struts(x, y, design, load):
    """Add the forces of the stops."""
    stop = design.stop
    stops = Stops(
        limit=design.strut.stroke_limit,
        stiffness=stop.stiffness,
        damping_per_step=stop.damping / stop.step_time,
    )
    force = np.zeros(load.pull.shape[0])
    solve_stops(x.state.stroke, y.state.stroke, design.force, stops, force)
    add_columns(y.whole, design.force, force)
    for i in range(force.shape[0]):
        load.total[i] += force[i]
