# SPDX-FileCopyrightText: 2026 The satvib authors
# SPDX-License-Identifier: Apache-2.0
"""One sample of the feedforward law of one item, from both accelerations to the voltage, in one kernel.

See `law` for what it does. What belongs to IDENTIFY, where the reaction is learnt, comes before it.
"""

from enum import IntEnum
from typing import NamedTuple

import numpy as np
from satvib_common.arrays import Array
from satvib_common.kernels.compile import body, kernel
from satvib_common.kernels.deferred import njit
from satvib_common.kernels.ordered_dot import dot_of

from satvib_control.laws.feedforward.backoff import (
    BackoffState,
    Judged,
    Settings,
    judge,
    pace_of,
    share_of,
)
from satvib_control.laws.feedforward.filtered_u import stabilize
from satvib_control.laws.feedforward.fxlms import fxlms
from satvib_control.laws.feedforward.fxrls import least_squares_step
from satvib_control.laws.feedforward.reaction import loop_gain
from satvib_control.laws.feedforward.regressor import is_filling, is_missing, measure
from satvib_control.laws.feedforward.regressor_kernel import (
    Contents,
    MotionFilter,
    Path,
    RegressorState,
    advance,
    filtered_of,
    plain_of,
)
from satvib_control.laws.feedforward.spikes import judge_error, limit_reference

POLE_RADIUS = 0.99  # that the poles of filtered_u stay inside
CUT = 1e-6  # V; less is rounding
LOOP_GAIN = 1.0  # largest |(n - 1) W F_hat| of n struts on one plate: small gain
TINY = 1e-300
BOOST = 1.05  # factor by which the leak rises per sample above it

_fxlms, _least_squares = body(fxlms), body(least_squares_step)
_stabilize, _loop_gain = body(stabilize), body(loop_gain)


class Given(IntEnum):
    """What is the same for all items on a sample; 1 for yes."""

    ACTING = 0  # the voltage of the law is let through
    ACTED = 1  # it was on the sample before
    ALONE = 2  # no excitation now or on the sample before
    LOST = 3  # samples that were lost before this one


class Setting(IntEnum):
    """Settings of all items."""

    DT = 0  # s
    FLOOR = 1  # m/s^2
    HOLD = 2  # samples, see `spikes`
    SETTLE = 3  # samples, see `regressor`
    STEP = 4  # mu
    LEAK = 5
    SHARE = 6  # of the present sample in means
    LEAST_SQUARES = 7  # 1: fxrls or filtered_u; 0: fxlms
    WEIGHT_LIMIT = 8
    RAIL = 9  # factor of the weights for each sample at the limit of the voltage
    OTHERS = 10  # struts whose reactions are in the reference
    MOST = 11  # largest boost of the leak


class Slot(IntEnum):
    """What is remembered of an item besides what filters and watches remember."""

    CLIPPED = 0  # samples until the regressor has no clipped one
    BOOST = 1  # of the leak
    DEMAND = 2  # V


class Shown(IntEnum):
    """What is shown of an item."""

    USUAL = 0  # m/s^2, the lower acceleration as it is used
    REFERENCE = 1  # m/s^2
    PREDICTED = 2  # m/s^2
    NORM = 3
    ADAPTING = 4  # 1: the weights moved
    WHY = 5  # `Why`


class Why(IntEnum):
    """What is to be said; of several the last one."""

    NOTHING = 0
    SATURATED = 1
    SMALL = 2
    CLIPPED = 3
    LISTENING = 4
    BACKED_OFF = 5
    FILLING = 6
    MISSING = 7
    GAVE_UP = 8
    NO_MODEL = 9


class _Filter(NamedTuple):
    """The adaptive filter of an item; see `LeastSquares`, `fxlms` and `RegressorState`."""

    weights: Array
    rows: Array
    power: Array
    U: Array
    d: Array
    squares: Array
    poles: int


@njit
def _why(state, loud, saturated, clipped, known, sensor):
    """What is to be said."""
    why = np.empty(1, np.int64)
    why[0] = Why.NOTHING
    if saturated:
        why[0] = Why.SATURATED
    if not loud:
        why[0] = Why.SMALL
    if clipped:
        why[0] = Why.CLIPPED
    if state == BackoffState.LISTEN or state == BackoffState.RING_DOWN:
        why[0] = Why.LISTENING
    if state == BackoffState.FADE or state == BackoffState.RESTART:
        why[0] = Why.BACKED_OFF
    if is_filling(sensor):
        why[0] = Why.FILLING
    if is_missing(sensor):
        why[0] = Why.MISSING
    if state == BackoffState.GIVEN_UP:
        why[0] = Why.GAVE_UP
    if not known:
        why[0] = Why.NO_MODEL
    return why[0]


@njit
def _adapt(error, active, pace, settings, boost, f):
    """Move the weights."""
    norm = np.empty(1)
    leak = min(settings[Setting.LEAK] * boost, 1.0)
    share = settings[Setting.SHARE]
    through = filtered_of(f.rows)
    if settings[Setting.LEAST_SQUARES] == 0.0:
        step = pace * settings[Setting.STEP]
        _fxlms(through, error, active, step, leak, share, f.weights, f.power, norm)
        return
    # the leak is a share of the power of the reference; that of past voltages depends on the weights
    plain = through[: f.weights.shape[0] - f.poles]
    gradient = f.rows[f.rows.shape[0] - 1]
    _least_squares(
        gradient, error, dot_of(plain, plain), active, pace, leak, share, f.weights, f.U, f.d,
        f.squares, norm,
    )  # fmt: skip
    if f.poles > 0:
        _stabilize(f.weights, f.poles, POLE_RADIUS, norm)


@njit
def _at_least(value, least):
    """The larger one; NaN stays."""
    return value if value > least or value != value else least


@njit
def _bound(cut, gone, settings, table, magnitude, memory, f):
    """Keep the weights within what the coil, the user and the other struts' reactions allow; give their norm."""
    limit = settings[Setting.WEIGHT_LIMIT]
    norm = np.sqrt(dot_of(f.weights, f.weights))
    scale = limit / _at_least(norm, 1e-300) if norm > limit else 1.0
    if cut:
        scale = scale * settings[Setting.RAIL]
    if gone:
        # the adaptation begins again with the next sample
        scale = 0.0
        f.power[:] = 0.0
        f.squares[:] = 0.0
    if settings[Setting.OTHERS] > 0.0:
        found = np.empty(1)
        _loop_gain(f.weights, table, f.poles, magnitude, found)
        gain = settings[Setting.OTHERS] * found[0]
        boost = memory[Slot.BOOST]
        boost = boost * BOOST if gain > LOOP_GAIN else boost / BOOST
        memory[Slot.BOOST] = min(max(boost, 1.0), settings[Setting.MOST])
        # the leak is slow; above twice the bound the weights are scaled at once
        # `TINY` changes nothing; the compiler divides by the gain before it compares, and NumPy reports a division by 0
        scale = scale * (2.0 * LOOP_GAIN / _at_least(gain + TINY, 2.0 * LOOP_GAIN))
    for i in range(f.weights.shape[0]):
        f.weights[i] *= scale
    return norm * scale


@njit
def _is_unclipped(upper_clipped, lower_clipped, taps, memory):
    """Whether neither the upper sample nor one of those in the regressor is clipped."""
    left = float(taps) if lower_clipped else max(memory[Slot.CLIPPED] - 1.0, 0.0)
    memory[Slot.CLIPPED] = left
    return left == 0.0 and not upper_clipped


@kernel(
    'void(f8,f8,f8,f8,b1,b1,b1,b1,b1,f8[:],f8[:],f8[:],f8[:],f8[:],f8[:,:,:],f8[:],f8[:],f8[:],i8[:],'
    'f8[:],f8[:],f8[:],f8[:,:],f8[:,:],f8[:,:],f8[:],f8[:],f8[:],f8[:],f8[:,:],f8[:],f8[:],f8[:],f8[:],f8[:])',
    '(),(),(),(),(),(),(),(),(),(e),(s),(b),(r),(f),(f,p,c),(m),(m),(h),(z),'
    '(p),(r),(q),(g,m),(l,d),(l,p),(a),(n),(i),(w),(v,v),(v),(o),(k),(t)->()',
    writable=(
        'weights', 'voltages', 'before', 'filters', 'motion', 'rows', 'sensor', 'spikes', 'backoff',
        'power', 'U', 'd', 'squares', 'memory', 'shown',
    ),
)  # fmt: skip
def feedforward_step(
    upper, lower, applied, fade, saturated, valid, upper_clipped, lower_clipped, known,
    given, settings, watching, reaction, magnitude, table, num, den, coefficients, sizes,
    weights, voltages, before, filters, motion, rows, sensor, spikes, backoff, power, U, d, squares,
    memory, shown, demand,
):  # fmt: skip
    """Take a sample.

    Args:
        upper, lower: () m/s^2; NaN in `lower`: not measured.
        applied: () V, of the sample before, as the guard let it through.
        fade: () share of that demand that went to the guard.
        saturated, valid, upper_clipped, lower_clipped: () bool, see `LawInput`.
        known: () bool; there is a model.
        given: (e) `Given`.
        settings: (s) `Setting`.
        watching: (b) `Settings` of the back-off.
        reaction, magnitude: (r), (f) see `ReferenceProtection`.
        table, num, den, coefficients, sizes: see `FilteredReference`.
        weights: (p) V/(m/s^2), changed.
        voltages, before, filters, motion, rows: `RegressorState`, changed.
        sensor, spikes, backoff, power, U, d, squares: what the parts remember, changed.
        memory: (k) `Slot`, changed.
        shown: (t) `Shown`, out.
        demand: () out, V.
    """
    acting, acted = given[Given.ACTING] > 0.0, given[Given.ACTED] > 0.0
    alone, dt, floor = given[Given.ALONE] > 0.0, settings[Setting.DT], settings[Setting.FLOOR]
    contents = Contents(sizes[0], sizes[1], sizes[2])
    path = Path(num, den, reaction, MotionFilter(coefficients[0], coefficients[1], coefficients[2]))
    state = RegressorState(voltages, before, filters, motion, rows)
    f = _Filter(weights, rows, power, U, d, squares, contents.poles)
    x = measure(lower, given[Given.LOST], contents.taps, settings[Setting.SETTLE], sensor)
    measured = not is_missing(sensor)
    usual = limit_reference(x, measured and alone, dt, floor, spikes)
    own = applied if acted else 0.0
    reference, effect = advance(usual, applied, own, path, contents, weights, state)
    able = measured and not is_filling(sensor)
    unclipped = _is_unclipped(upper_clipped, lower_clipped, contents.taps, memory)
    # cut by the limit, and not only because another law has its share
    cut = saturated and acted and abs(applied - memory[Slot.DEMAND] * fade) > CUT
    predicted = upper - effect
    error = predicted + dot_of(weights, filtered_of(rows))
    whole = valid and unclipped and able and alone
    hold = settings[Setting.HOLD]
    shaken, shock = judge_error(error, predicted, whole, dt, floor, hold, spikes)
    sample = Judged(upper, reference, effect if acted else 0.0, cut, whole and not shock, acting)
    now, loud = judge(sample, Settings(watching[0], watching[1], watching[2]), backoff)
    able = able and known
    learns = now == BackoffState.ACT or now == BackoffState.LISTEN
    active = able and learns and loud and whole and not saturated and acting and not shaken
    _adapt(error, active, pace_of(backoff), settings, memory[Slot.BOOST], f)
    gone = now == BackoffState.RESTART or now == BackoffState.GIVEN_UP
    norm = _bound(cut, gone, settings, table, magnitude, memory, f)
    wanted = share_of(backoff) * dot_of(weights, plain_of(rows))
    demand[0] = wanted if able and acting else 0.0
    memory[Slot.DEMAND] = demand[0]
    shown[Shown.USUAL], shown[Shown.REFERENCE] = usual, reference
    shown[Shown.PREDICTED], shown[Shown.NORM] = predicted, norm
    shown[Shown.ADAPTING] = 1.0 if active else 0.0
    shown[Shown.WHY] = _why(now, loud, saturated and acted, not whole, known, sensor)
