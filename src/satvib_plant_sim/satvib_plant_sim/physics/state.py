# SPDX-FileCopyrightText: 2026 The satvib authors
# SPDX-License-Identifier: Apache-2.0
"""The state of mechanics and coils: which number of a vector is what.

The same views serve numbers, matrices and indices: `state_of(np.arange(size), n).current` are the indices of the
currents. Compiled code calls `compiled_state_of`.
"""

from enum import IntEnum
from typing import Any, NamedTuple

from satvib_common.kernels.deferred import njit


class PlateSlot(IntEnum):
    """The motion of the lower plate, relative to the shaker's source."""

    POSITION = 0  # z, m
    RATE = 1  # z', m/s


class State(NamedTuple):
    """Views of the first 3n + 2 numbers of a vector, for n struts.

    Attributes:
        stroke: (n) s, m.
        rate: (n) s', m/s.
        current: (n) i, A.
        plate: (2) `PlateSlot`.
    """

    stroke: Any
    rate: Any
    current: Any
    plate: Any


def state_size(n: int) -> int:
    """Give the length of the state of n struts."""
    return 3 * n + 2


def state_of(x: Any, n: int) -> State:
    """Give the views of a vector x (at least 3n + 2)."""
    return State(
        stroke=x[:n],
        rate=x[n : 2 * n],
        current=x[2 * n : 3 * n],
        plate=x[3 * n : 3 * n + 2],
    )


compiled_state_of = njit(state_of)
