# SPDX-FileCopyrightText: 2026 The satvib authors
# SPDX-License-Identifier: Apache-2.0
"""Holds a strut at 0 V for a while, asked from outside: the law keeps what it has learnt, and comes back.

A hold ends with `release`, or by itself after `LONGEST_HOLD`: whoever asked for it may be gone.
"""

import numpy as np
from satvib_common.arrays import Array, Mask

FADE_TIME = 0.1  # s, to 0 V
RETURN_TIME = 0.3  # s, back to the law's voltage
LONGEST_HOLD = 20.0  # s


class Hold:
    """Which struts are held.

    Args:
        dt: s.
        shape: leading axes.

    Attributes:
        busy: some strut is held or comes back; else nothing here needs to be computed.
        held: shape, bool.
    """

    def __init__(self, dt: float, shape: tuple[int, ...] = ()) -> None:
        self._dt, self._shape = dt, shape
        self.busy = False
        self.held: Mask = np.zeros(shape, dtype=bool)
        self._left = np.zeros(shape)
        self._share = np.ones(shape)

    def begin(self, mask: Mask | bool = True) -> None:
        """Hold where `mask` (shape) holds."""
        self.held = self.held | mask
        self._left = np.where(mask, LONGEST_HOLD, self._left)
        self.busy = bool(self.held.any())

    def end(self, mask: Mask | bool = True) -> None:
        """Release where `mask` (shape) holds."""
        self.held = self.held & ~np.asarray(mask)

    def step(self, interrupted: Mask | None = None) -> Array:
        """Give the share of the law's voltage (shape) for the next sample; 0 where (shape) it is interrupted."""
        if interrupted is not None and not interrupted.any():
            interrupted = None
        if not self.busy and interrupted is None:
            return self._share
        self._left = self._left - self._dt
        self.held = self.held & (self._left > 0.0)
        change = np.where(self.held, -self._dt / FADE_TIME, self._dt / RETURN_TIME)
        self._share = np.minimum(np.maximum(self._share + change, 0.0), 1.0)
        if interrupted is not None:
            self._share = np.where(interrupted, 0.0, self._share)
        self.busy = bool((self.held | (self._share < 1.0)).any())
        return self._share
