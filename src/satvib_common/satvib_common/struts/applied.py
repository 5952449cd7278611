# SPDX-FileCopyrightText: 2026 The satvib authors
# SPDX-License-Identifier: Apache-2.0
"""What became of a voltage that a controller asked for: the states, their texts, and how the samples follow each other.

The source of the samples (`plant_sim`, `daq_bridge`) says it with each sample of a strut, for the sample before.
"""

from enum import IntEnum


class Applied(IntEnum):
    """What a coil got; the numbers are those of satvib_msgs/VoltageApplied."""

    UNKNOWN = 0
    APPLIED = 1
    LIMITED = 2
    RETURNING = 3
    WAITING = 4
    SILENT = 5
    LATCHED = 6


def applied_of(number: int) -> Applied:
    """Give the state of a number in a message; a number that is none says nothing."""
    return _STATES.get(number, Applied.UNKNOWN)


_STATES = {int(state): state for state in Applied}


class Pace(IntEnum):
    """How samples follow each other; the numbers are those of satvib_msgs/StrutAcceleration."""

    UNKNOWN = 0
    CLOCK = 1
    LOCKSTEP = 2


# from here on the coil did not get what was asked for, and a law must not learn from what it asked for
CHANGED = Applied.LIMITED
# from here on it got 0 V
WITHHELD = Applied.WAITING

TEXTS = {
    Applied.UNKNOWN: '',
    Applied.APPLIED: '',
    Applied.LIMITED: 'a limit of the source of the samples changes the voltage',
    Applied.RETURNING: 'the voltage rises to its full value: it was not fresh for a while',
    Applied.WAITING: '0 V: the source of the samples has no voltage of this strut yet, or is not armed',
    Applied.SILENT: '0 V: the source of the samples got no fresh voltage for too long; it goes on when it gets some',
    Applied.LATCHED: '0 V: latched by the source of the samples, until its service reset is called',
}
