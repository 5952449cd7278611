# SPDX-FileCopyrightText: 2026 The satvib authors
# SPDX-License-Identifier: Apache-2.0
"""Recursive extended least squares: the noise has a model of its own, and so causes no bias in that of the plant.

    A(q) y = B(q) u + C(q) e,   w_x = [w, r(k-1) ... r(k-c)],   r(k) = y(k) - w_x(k)^T theta(k)

Sensor noise on the output of the paper's model is A(q) e. Plain least squares assumes white noise, so its bias never
vanishes; with c = n this model describes the noise exactly. It converges where 1/C - 1/2 is positive real: for well
damped poles. For poles near the unit circle use the instrumental variable.

L. Ljung and T. Soederstroem, Theory and Practice of Recursive Identification, 1983, section 2.2.3 (RELS).
"""

import numpy as np
from numpy.typing import ArrayLike
from satvib_common.arrays import Array, Mask
from satvib_common.errors import SatvibError
from satvib_common.kernels.compile import kernel
from satvib_common.kernels.ordered_dot import dot_of

from satvib_ident.estimators.least_squares import RecursiveLeastSquares
from satvib_ident.forgetting.protocol import Forgetting


@kernel(
    'void(f8[:], f8, b1, f8[:], f8[:], f8[:], f8[:], b1[:])',
    '(p),(),(),(c),(q)->(q),(),()',
    writable=('residual',),
)
def _extend(w, y, active, residual, theta, extended, error, use):
    """Form w_x and its prediction error; an output that is not finite is not used, and breaks the residuals."""
    p = w.shape[0]
    known = abs(y) < np.inf
    if not known:
        residual[:] = 0.0
    for i in range(theta.shape[0]):
        extended[i] = w[i] if i < p else residual[i - p]
    error[0] = (y if known else 0.0) - dot_of(extended, theta)
    use[0] = active and known and abs(error[0]) < np.inf


@kernel(
    'void(f8[:], f8, f8[:], f8[:], f8[:], f8[:])',
    '(q),(),(q),(c),(s)->()',
    writable=('residual', 'peak'),
)
def _leave(extended, y, theta, residual, peak, left):
    """Keep the residual r(k), no larger than the signal itself has been; `peak` is that, (1)."""
    shown = dot_of(extended, theta)
    known = abs(y) < np.inf
    rest = y - shown if known and shown == shown else 0.0
    # a residual larger than the signal comes from a wrong noise model; without a bound it would grow by itself
    peak[0] = max(min(abs(y), 1e50) if known else 0.0, 0.999 * peak[0])
    left[0] = min(max(rest, -peak[0]), peak[0])
    for i in range(residual.shape[0] - 1, 0, -1):
        residual[i] = residual[i - 1]
    residual[0] = left[0]


class ExtendedLeastSquares(RecursiveLeastSquares):
    """Least squares with `noise` further parameters c1..; theta is (*shape, p + noise).

    Args:
        count: p, parameters of the plant.
        noise: c, coefficients of C(q).
        shape: leading axes.
        forgetting: what happens to old data.
        initial_covariance: diagonal of P(0).
        initial_theta: theta(0) of the plant, (p) or a scalar; the noise starts from 0.
        limit: largest trace of P that forgetting may reach.
    """

    keeps_signals = True

    def __init__(
        self,
        count: int,
        noise: int,
        shape: tuple[int, ...] = (),
        forgetting: Forgetting | None = None,
        initial_covariance: float = 1e18,
        initial_theta: ArrayLike = 0.0,
        limit: float = 0.0,
    ) -> None:
        if noise < 1:
            raise SatvibError(f'noise_coefficients: {noise}; at least one is needed')
        theta = np.zeros(count + noise)
        theta[:count] = np.asarray(initial_theta, dtype=float)
        super().__init__(count + noise, shape, forgetting, initial_covariance, theta, limit)
        self.plant = count
        self._residual = np.zeros((*shape, noise))
        self._peak = np.zeros((*shape, 1))

    def update(self, w: Array, y: Array, active: Mask | bool = True) -> Array:
        """Take one sample; `w` is that of the plant, (*shape, p)."""
        extended, error, use = _extend(w, y, active, self._residual, self.theta)
        self.correct(extended, error, use)
        _leave(extended, y, self.theta, self._residual, self._peak)
        return np.asarray(error)

    def interrupt(self, mask: Mask | bool = True) -> None:
        """Forget the residuals where `mask` (shape) holds."""
        self._residual[...] = np.where(np.asarray(mask)[..., None], 0.0, self._residual)

    def reset(self, mask: Mask | bool = True) -> None:
        """Start again where `mask` (shape) holds."""
        super().reset(mask)
        self._peak[...] = np.where(np.asarray(mask)[..., None], 0.0, self._peak)
        self.interrupt(mask)
