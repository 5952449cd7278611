# SPDX-FileCopyrightText: 2026 The satvib authors
# SPDX-License-Identifier: Apache-2.0
"""Finite window: the estimate is that of the last N samples used, and of the prior, alone.

The oldest sample is taken out before the new one comes in:

    P <- P + P w_o w_o^T P / (1 - w_o^T P w_o),   theta <- theta - P w_o (y_o - w_o^T theta) / (1 - w_o^T P w_o)

Memory: N (p + 1) numbers per item. Samples that are not used do not slide the window, so silence leaves it as it is.
"""

from enum import IntEnum

import numpy as np
from satvib_common.arrays import Array, Mask
from satvib_common.errors import SatvibError
from satvib_common.kernels.compile import kernel
from satvib_common.kernels.deferred import njit
from satvib_common.kernels.ordered_dot import dot_of
from satvib_common.kernels.ud import column_product, measure_one

from satvib_ident.covariance.ud import add_one
from satvib_ident.forgetting.none import ONE, NoForgetting
from satvib_ident.forgetting.protocol import Factors

ROUNDS = 4.0  # after which the factors are built up again


class Window(IntEnum):
    """Places of the state of the window."""

    HELD = 0  # samples
    NEXT = 1  # place of the next one
    ROUNDS = 2  # since the last building up


@njit(inline='always')
def _remove(w, y, theta, U, d, work):
    """Take a sample out of (theta, P); gives False, and changes nothing, where rounding would decide."""
    p = d.shape[0]
    share = 0.0
    error = y
    for j in range(p):
        f = column_product(j, U, w)
        work[j] = d[j] * f
        share += f * work[j]
        error -= w[j] * theta[j]
    left = 1.0 - share
    if not left > 1e-4:
        return False
    for i in range(p):  # P w = U (D U^T w)
        total = work[i]
        for j in range(i + 1, p):
            total += U[i, j] * work[j]
        work[i] = total
        theta[i] -= total / left * error
    add_one(1.0 / left, U, d, work)
    return True


@kernel(
    'void(f8[:], f8, b1, f8[:], f8[:], f8[:,:], f8[:], f8[:], f8[:,:], f8[:], f8[:], f8[:], b1[:])',
    '(p),(),(),(p),(p),(s,q),(c),(p),(p,p),(p)->(p),(),()',
    writable=('ring', 'state', 'theta', 'U', 'd'),
)
def _slide(w, error, active, theta0, P0, ring, state, theta, U, d, work, rest, used):
    """Make room for a sample in a window: take the oldest out of (theta, U, d), and remember the new one.

    Every fourth round, and where a removal is nearly singular, everything is built up again from the samples held, so
    that rounding errors do not add up. The caller measures the new sample afterwards.

    Args:
        w: (p) new regressor.
        error: () its prediction error.
        active: () bool; nothing changes where it is false.
        theta0: (p) estimate before any data.
        P0: (p) diagonal covariance before any data.
        ring: (s, p + 1) samples held, changed.
        state: (3) see `Window`, changed.
        theta: (p), changed.
        U: (p, p), changed.
        d: (p), changed.
        work: (p) out, for the kernel alone.
        rest: () out, the prediction error of what is left.
        used: () out, whether the sample is to be used.
    """
    p = d.shape[0]
    rest[0] = error
    # what `measure` would refuse must not get into the window either
    work[:] = 0.0
    used[0] = active and abs(error) < 1e100 and dot_of(w, w) < 1e200
    if not used[0]:
        return
    output = error + dot_of(w, theta)
    size = ring.shape[0]
    held = int(state[Window.HELD])
    place = int(state[Window.NEXT])
    sound = True
    if held == size:
        sound = _remove(ring[place, :p], ring[place, p], theta, U, d, work)
    if held == size and place == 0:
        state[Window.ROUNDS] += 1.0
    if held == size and (not sound or state[Window.ROUNDS] >= ROUNDS):
        state[Window.ROUNDS] = 0.0
        for j in range(p):
            theta[j] = theta0[j]
            d[j] = P0[j]
            for i in range(p):
                U[i, j] = 1.0 if i == j else 0.0
        for step in range(1, size):
            k = place + step if place + step < size else place + step - size
            old = ring[k, p]
            for j in range(p):
                old -= ring[k, j] * theta[j]
            measure_one(ring[k, :p], old, 1.0, theta, U, d, work)
    for j in range(p):
        ring[place, j] = w[j]
    ring[place, p] = output
    state[Window.HELD] = min(held + 1, size)
    state[Window.NEXT] = place + 1 if place + 1 < size else 0
    rest[0] = output - dot_of(w, theta)


class FiniteWindow(NoForgetting):
    """Keep `size` samples; for estimators whose gain is along their own regressor (least squares, extended)."""

    def __init__(self, size: int) -> None:
        if size < 1:
            raise SatvibError(f'window: {size} samples; at least one is needed')
        self.size = size

    def bind(self, estimator: Factors) -> None:
        """Make the window and remember the prior."""
        self._theta0 = estimator.theta.copy()
        self._P0 = estimator.d.copy()
        # items lie side by side: they are mostly at the same place of their windows
        ring = np.zeros((self.size, *estimator.shape, estimator.count + 1))
        self._ring = np.moveaxis(ring, 0, -2)
        self._state = np.zeros((*estimator.shape, len(Window)))

    def apply(
        self, estimator: Factors, w: Array, error: Array, active: Mask
    ) -> tuple[Array, Array, Mask]:
        """Take the oldest sample out and remember the new one; the error is then that of the rest."""
        _, rest, used = _slide(
            w, error, active, self._theta0, self._P0,
            self._ring, self._state, estimator.theta, estimator.U, estimator.d,
        )  # fmt: skip
        return ONE, rest, used

    def reset(self, mask: Mask) -> None:
        """Empty the window."""
        self._state[...] = np.where(mask[..., None], 0.0, self._state)
