# SPDX-FileCopyrightText: 2026 The satvib authors
# SPDX-License-Identifier: Apache-2.0
"""The recent samples of a signal, for kernels and for the measures of trust.

A ring holds every value twice, half its length apart. So the window always lies in one piece.
"""

from enum import IntEnum

import numpy as np
from satvib_common.arrays import Mask
from satvib_common.kernels.deferred import njit


class Recent(IntEnum):
    """Places of the state of a ring."""

    HELD = 0
    NEXT = 1


@njit(inline='always')
def put(value, ring, state):
    """Put a value at the next place of a ring (2 window); `move_on` follows."""
    size = ring.shape[0] // 2
    place = int(state[Recent.NEXT])
    ring[place] = value
    ring[place + size] = value


@njit(inline='always')
def move_on(size, state):
    """Count a sample in the state of a ring whose window has a size."""
    state[Recent.HELD] = min(state[Recent.HELD] + 1.0, size)
    state[Recent.NEXT] = (int(state[Recent.NEXT]) + 1) % size


@njit(inline='always')
def latest(ring, state):
    """Give the values held, the oldest first."""
    held = int(state[Recent.HELD])
    start = int(state[Recent.NEXT]) + ring.shape[0] // 2 - held
    return ring[start : start + held]


class RecentSamples:
    """State of the rings of a batch.

    Args:
        shape: leading axes.
    """

    def __init__(self, shape: tuple[int, ...]) -> None:
        self._state = np.zeros((*shape, len(Recent)))

    def clear(self, mask: Mask | bool = True) -> None:
        """Empty the window where `mask` (shape) holds."""
        self._state[...] = np.where(np.asarray(mask)[..., None], 0.0, self._state)
