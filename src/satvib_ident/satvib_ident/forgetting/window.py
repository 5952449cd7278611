# SPDX-FileCopyrightText: 2026 The satvib authors
# SPDX-License-Identifier: Apache-2.0
"""Finite window: the estimate is that of the last N samples used, and of the prior, alone.

The oldest sample is taken out before the new one comes in:

    P <- P + P w_o w_o^T P / (1 - w_o^T P w_o),   theta <- theta - P w_o (y_o - w_o^T theta) / (1 - w_o^T P w_o)

Memory: N (p + 1) numbers per item. Samples that are not used do not slide the window, so silence leaves it as it is.
"""

import numpy as np
from numpy.typing import NDArray
from satvib_common.errors import SatvibError

from satvib_ident import ud
from satvib_ident.forgetting.none import NoForgetting
from satvib_ident.forgetting.protocol import Factors

Array = NDArray[np.float64]
Mask = NDArray[np.bool_]


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
        self._ring = np.zeros((*estimator.shape, self.size, estimator.count + 1))
        self._state = np.zeros((*estimator.shape, 2))

    def apply(
        self, estimator: Factors, w: Array, error: Array, active: Mask
    ) -> tuple[Array | float, Array, Mask]:
        """Take the oldest sample out and remember the new one; the error is then that of the rest."""
        # what `measure` would refuse must not get into the window either
        active = active & (np.abs(error) < 1e100) & (ud.dot(w, w) < 1e200)
        y = error + ud.dot(w, estimator.theta)
        ud.slide(
            w, y, active, self._theta0, self._P0,
            self._ring, self._state, estimator.theta, estimator.U, estimator.d,
        )  # fmt: skip
        return 1.0, np.where(active, y - ud.dot(w, estimator.theta), error), active

    def reset(self, mask: Mask) -> None:
        """Empty the window."""
        self._state[...] = np.where(mask[..., None], 0.0, self._state)
