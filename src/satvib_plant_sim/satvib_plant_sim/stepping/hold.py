# SPDX-FileCopyrightText: 2026 The satvib authors
# SPDX-License-Identifier: Apache-2.0
"""The voltage between commands: steps (`zero`) or straight lines of one period (`linear`).

A strut's voltage is v0 + (v1 - v0) clip((t - t0) / T, 0, 1) since the arrival t0 of its last command v1; under zero
hold v0 = v1. A command that arrives before the last line has ended starts from the present voltage.

Times are counted in fine steps from the beginning of the period: a whole number, and a flag that says whether the
rig's fraction theta of a step is added.
"""

from enum import IntEnum
from typing import Any, NamedTuple

import numpy as np
from satvib_common.arrays import Array
from satvib_common.kernels.deferred import njit

_NEVER = 1e18  # fine steps


class RampSlot(IntEnum):
    """The line of one strut's voltage, which is kept from period to period."""

    START = 0  # v0, V
    END = 1  # v1, V
    STEP = 2  # t0, whole fine steps
    AT_THETA = 3  # 1: t0 is theta later, else 0


class EventSlot(IntEnum):
    """When a strut's command takes effect in the period."""

    STEP = 0  # whole fine steps; n_fine is the end of the period, below 0 is never
    AT_THETA = 1  # 1: theta later, else 0


class Line(NamedTuple):
    """Voltages as straight lines, or their changes, (n) each: level at time 0, V, and slope, V per fine step."""

    level: Any
    slope: Any


class Voltages(NamedTuple):
    """The voltages of a period.

    Attributes:
        ramp: (n, 4) `RampSlot`, kept.
        line: within the present piece of the period.
        change: jump of level and slope at the last event, which a divided step needs.
        command: (n) V.
        event: (n, 2) `EventSlot`.
        n_fine, theta: fine steps in a period; fraction of a step.
        linear: whether the hold is linear.
    """

    ramp: Any
    line: Line
    change: Line
    command: Any
    event: Any
    n_fine: Any
    theta: Any
    linear: Any


def resting_ramps(trials: int, n: int, n_fine: int) -> Array:
    """Give the ramps (trials, n, 4) at the beginning: 0 V, whose line has ended long ago."""
    ramps = np.zeros((trials, n, len(RampSlot)))
    ramps[:, :, RampSlot.STEP] = -2.0 * n_fine
    return ramps


def events_at(step: Array, at_theta: Array) -> Array:
    """Give the events (..., 2) for whole fine steps (...) and flags (...)."""
    events = np.empty((*step.shape, len(EventSlot)))
    events[..., EventSlot.STEP], events[..., EventSlot.AT_THETA] = step, at_theta
    return events


@njit
def begin_period(v):
    """Make the lines from the ramps at the start of a period."""
    ramp, line, n_fine = v.ramp, v.line, v.n_fine
    for i in range(ramp.shape[0]):
        left = ramp[i, RampSlot.STEP] + n_fine
        at_rest = ramp[i, RampSlot.START] == ramp[i, RampSlot.END] or left < 0.0
        if at_rest or (left == 0.0 and ramp[i, RampSlot.AT_THETA] == 0.0):
            ramp[i, RampSlot.START] = ramp[i, RampSlot.END]
            line.level[i] = ramp[i, RampSlot.END]
            line.slope[i] = 0.0
        else:
            slope = (ramp[i, RampSlot.END] - ramp[i, RampSlot.START]) / n_fine
            began = ramp[i, RampSlot.STEP] + ramp[i, RampSlot.AT_THETA] * v.theta
            line.slope[i] = slope
            line.level[i] = ramp[i, RampSlot.START] - slope * began


@njit
def end_period(v):
    """Count the ramps' times from the beginning of the next period."""
    for i in range(v.ramp.shape[0]):
        v.ramp[i, RampSlot.STEP] -= v.n_fine


@njit
def _line_end(v, i):
    """Give the fine step in which the line of strut i ends; a strut at rest has no end."""
    if v.ramp[i, RampSlot.START] == v.ramp[i, RampSlot.END]:
        return _NEVER
    return v.ramp[i, RampSlot.STEP] + v.n_fine


@njit
def next_event(v, after):
    """Give the first fine step later than `after` in which any strut's line ends or a command arrives."""
    first = _NEVER
    for i in range(v.ramp.shape[0]):
        end = _line_end(v, i)
        if after < end < first:
            first = end
        if after < v.event[i, EventSlot.STEP] < first:
            first = v.event[i, EventSlot.STEP]
    return first


@njit
def change_lines(v, j, at_theta):
    """Apply what happens in fine step j, on the grid (flag 0) or at theta (flag 1); gives whether anything did."""
    happened = False
    for i in range(v.ramp.shape[0]):
        v.change.level[i] = 0.0
        v.change.slope[i] = 0.0
        end = _line_end(v, i)
        ends = end == j and v.ramp[i, RampSlot.AT_THETA] == at_theta
        arrives = v.event[i, EventSlot.STEP] == j and v.event[i, EventSlot.AT_THETA] == at_theta
        if ends or arrives:
            happened = True
            _change_line(v, i, j, at_theta, ends or end == _NEVER, arrives)
    return happened


@njit
def _change_line(v, i, j, at_theta, ended, arrives):
    """End the line of strut i in fine step j, or begin the next one when its command arrives."""
    ramp, line, t = v.ramp, v.line, j + at_theta * v.theta
    now = ramp[i, RampSlot.END] if ended else line.level[i] + line.slope[i] * t
    slope = 0.0
    value = now
    ramp[i, RampSlot.START] = now
    if arrives:
        ramp[i, RampSlot.END] = v.command[i]
        ramp[i, RampSlot.STEP] = j
        ramp[i, RampSlot.AT_THETA] = at_theta
        if v.linear:
            slope = (v.command[i] - now) / v.n_fine
        else:
            value = v.command[i]
            ramp[i, RampSlot.START] = value
    else:
        ramp[i, RampSlot.END] = now
    v.change.level[i] = value - (line.level[i] + line.slope[i] * t)
    v.change.slope[i] = slope - line.slope[i]
    line.slope[i] = slope
    line.level[i] = value - slope * t
