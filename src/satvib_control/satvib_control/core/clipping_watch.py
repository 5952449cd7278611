# SPDX-FileCopyrightText: 2026 The satvib authors
# SPDX-License-Identifier: Apache-2.0
"""A strut whose upper sensor clips goes to 0 V: its samples cannot say what the law does.

A single clipped sample (a shock) is not learnt from, and that is all. A sensor clips *for long* where more than
`clipping_limit` of the samples of about a second (`SHARE_TIME`) are clipped. The vibration is then larger than its
samples say, and a law that makes it worse does not show in them: the vibration watch sees the same power.

| state | leaves when | next | voltage |
|---|---|---|---|
| acting | clipped for long | paused | the law's |
| paused | the share is below a fifth of the limit | acting | fades to 0; the law begins at rest |

If the sensor still clips `RING_TIME` after the voltage is gone, the disturbance alone is too large for it: the strut
waits at 0 V for as long as that takes. If it does not, the law is the likely cause: a strike. The third one is a fault.
`FORGIVE_TIME` without a pause takes one strike back.
"""

import numpy as np
from satvib_common.arrays import Array, Mask, every, some

SHARE_TIME = 1.0  # s
BACK = 0.2  # of the limit
FADE_TIME = 0.1  # s, to 0 V
RETURN_TIME = 0.3  # s, back to the law's voltage
RING_TIME = 0.6  # s from the beginning of the pause, the fade and the ringing of the strut included
STRIKES = 3
FORGIVE_TIME = 60.0  # s
_NOTHING = 1e-9  # a share below it is none, so that quiet struts need no work


class ClippingWatch:
    """Pauses the law of a strut whose upper sensor clips for long.

    Args:
        limit: share of clipped samples above which the law pauses; 1 or more: never.
        dt: s.
        shape: leading axes.
        together: the struts of the last axis share one law, and pause together.

    Attributes:
        busy: some sensor clips or has clipped, or some law is paused; else nothing here needs to be computed.
    """

    def __init__(
        self, limit: float, dt: float, shape: tuple[int, ...] = (), together: bool = False
    ) -> None:
        self.limit, self.dt, self.shape, self._together = limit, dt, shape, together
        self.reset()

    def reset(self) -> None:
        """Forget everything."""
        self.busy = False
        self.paused = np.zeros(self.shape, dtype=bool)
        self._share = np.zeros(self.shape)
        self._scale = np.ones(self.shape)
        self._clock = np.zeros(self.shape)  # s since the pause began
        self._last = np.zeros(self.shape)  # s from its beginning to the last clipped sample
        self._strikes = np.zeros(self.shape)
        self._peace = np.zeros(self.shape)  # s without a pause

    def step(self, clipped: Mask, acting: bool) -> tuple[Array, Mask, Mask]:
        """Take a sample.

        Args:
            clipped: shape, the upper sensor stands at an end of its range.
            acting: the law's voltage is let through in this phase.

        Returns:
            (shape) share of the law's voltage to let through; where the law must begin at rest; where it has failed.
        """
        if not (self.busy or some(clipped)):
            return self._scale, self.paused, self.paused
        if self._together:
            clipped = np.broadcast_to(np.any(clipped, axis=-1, keepdims=True), self.shape)
        dt = self.dt
        share = self._share + (clipped - self._share) * min(dt / SHARE_TIME, 1.0)
        self._share = np.where(share > _NOTHING, share, 0.0)
        begins = ~self.paused & (self._share > self.limit) & acting
        self._clock = np.where(begins, 0.0, self._clock + dt)
        self._last = np.where(begins, 0.0, np.where(clipped, self._clock, self._last))
        ends = self.paused & (self._share < BACK * self.limit)
        strike = ends & (self._last < RING_TIME)
        self.paused = (self.paused | begins) & ~ends
        self._peace = np.where(self.paused, 0.0, self._peace + dt)
        forgiven = (self._peace >= FORGIVE_TIME) & (self._strikes > 0.0)
        self._peace = np.where(forgiven, 0.0, self._peace)
        self._strikes = self._strikes + strike - forgiven
        change = np.where(self.paused, -dt / FADE_TIME, dt / RETURN_TIME)
        self._scale = np.minimum(np.maximum(self._scale + change, 0.0), 1.0)
        quiet = (self._share == 0.0) & (self._scale == 1.0) & (self._strikes == 0.0)
        self.busy = not every(quiet)
        return self._scale, ends, self._strikes >= STRIKES
