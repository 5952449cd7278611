# SPDX-FileCopyrightText: 2026 The satvib authors
# SPDX-License-Identifier: Apache-2.0
"""The voltage between commands: steps (`zero`) or straight lines of one period (`linear`).

A strut's voltage is v0 + (v1 - v0) clip((t - t0) / T, 0, 1) since the arrival t0 of its last command v1; under zero
hold v0 = v1. A command that arrives before the last line has ended starts from where the voltage is.

Times are counted in fine steps from the beginning of the period: a whole number, and a flag that says whether the
rig's fraction theta of a step comes on top. `ramp` (n, 4) holds v0, v1, whole t0, flag; within a period the voltage of
strut i is `line[0, i] + t line[1, i]`.
"""

from numba import njit


@njit
def begin_lines(ramp, n_fine, theta, line):
    """Fill `line` (2, n) from `ramp` (n, 4) at the start of a period."""
    for i in range(ramp.shape[0]):
        left = ramp[i, 2] + n_fine
        if ramp[i, 0] == ramp[i, 1] or left < 0.0 or (left == 0.0 and ramp[i, 3] == 0.0):
            ramp[i, 0] = ramp[i, 1]
            line[0, i] = ramp[i, 1]
            line[1, i] = 0.0
        else:
            slope = (ramp[i, 1] - ramp[i, 0]) / n_fine
            line[1, i] = slope
            line[0, i] = ramp[i, 0] - slope * (ramp[i, 2] + ramp[i, 3] * theta)


@njit
def line_ends(ramp, n_fine, i):
    """Fine step in which the line of strut i ends; far away when it has none."""
    if ramp[i, 0] == ramp[i, 1]:
        return 1e18
    return ramp[i, 2] + n_fine


@njit
def next_event(ramp, event, n_fine, after):
    """First fine step later than `after` in which any strut's line ends or a command (`event`, (n, 2)) arrives."""
    first = 1e18
    for i in range(ramp.shape[0]):
        end = line_ends(ramp, n_fine, i)
        if after < end < first:
            first = end
        if after < event[i, 0] < first:
            first = event[i, 0]
    return first


@njit
def turn(ramp, line, event, command, linear, n_fine, theta, j, flag, change):
    """Apply what happens in fine step j, on the grid (flag 0) or at theta (flag 1).

    `change` (2, n) takes the jump of the voltage and of its slope, which the divided step needs. Returns whether
    anything happened.
    """
    happened = False
    for i in range(ramp.shape[0]):
        change[0, i] = 0.0
        change[1, i] = 0.0
        t = j + flag * theta
        end = line_ends(ramp, n_fine, i)
        ends = end == j and ramp[i, 3] == flag
        arrives = event[i, 0] == j and event[i, 1] == flag
        if not (ends or arrives):
            continue
        happened = True
        now = ramp[i, 1] if ends or end > 1e17 else line[0, i] + line[1, i] * t
        slope = 0.0
        value = now
        ramp[i, 0] = now
        if arrives:
            ramp[i, 1] = command[i]
            ramp[i, 2] = j
            ramp[i, 3] = flag
            if linear:
                slope = (command[i] - now) / n_fine
            else:
                value = command[i]
                ramp[i, 0] = value
        else:
            ramp[i, 1] = now
        change[0, i] = value - (line[0, i] + line[1, i] * t)
        change[1, i] = slope - line[1, i]
        line[1, i] = slope
        line[0, i] = value - slope * t
    return happened
