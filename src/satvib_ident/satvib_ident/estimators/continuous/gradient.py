# SPDX-FileCopyrightText: 2026 The satvib authors
# SPDX-License-Identifier: Apache-2.0
"""The gradient estimator in continuous time, integrated exactly over a sample.

    theta' = -g w e1,   e1 = w^T theta - y                                     after Eq. (5)

While w and y stand still e1 decays as exp(-g |w|^2 t), so over a sample

    theta <- theta - w e1 (1 - exp(-g |w|^2 dt)) / |w|^2

whatever the size of g. It has no covariance and knows no forgetting; it converges only as fast as the least excited
direction lets it.
"""

import math

import numpy as np
from numpy.typing import ArrayLike
from satvib_common.arrays import Array, Mask
from satvib_common.errors import SatvibError
from satvib_common.kernels.compile import kernel
from satvib_common.kernels.ordered_dot import dot, dot_of

from satvib_ident.estimators.least_squares import RecursiveLeastSquares


@kernel('void(f8[:], f8, f8, b1, f8[:], b1[:])', '(p),(),(),(),(p)->()', writable=('theta',))
def _descend(w, error, step, active, theta, used):
    used[0] = False
    size = dot_of(w, w)
    if not active or not size < 1e280 or not abs(error) < 1e140:
        return
    used[0] = True
    x = step * size
    # (1 - exp(-x)) / size, also where both are nothing
    factor = step * (1.0 - 0.5 * x) if x < 1e-6 else (1.0 - math.exp(-min(x, 700.0))) / size
    for j in range(w.shape[0]):
        moved = theta[j] + w[j] * error * factor
        if abs(moved) < 1e150:
            theta[j] = moved


class GradientEstimator(RecursiveLeastSquares):
    """Steepest descent for every item of `shape`.

    Args:
        count: number of parameters p.
        dt: s, sample period.
        shape: leading axes.
        gain: g.
        initial_theta: theta(0), (p).
    """

    def __init__(
        self,
        count: int,
        dt: float,
        shape: tuple[int, ...] = (),
        gain: float = 1.0,
        initial_theta: ArrayLike = 0.0,
    ) -> None:
        super().__init__(count, shape, None, 1.0, initial_theta)
        if not gain > 0.0:
            raise SatvibError(f'gradient estimator: gain {gain} is not positive')
        self.step = gain * dt
        self._squares = np.zeros(shape)

    def update(self, w: Array, y: Array, active: Mask | bool = True) -> Array:
        """Integrate over one sample; gives -e1 at its start (shape)."""
        error: Array = y - dot(w, self.theta)
        use = np.isfinite(error) & active
        self.used = np.asarray(_descend(w, np.where(use, error, 0.0), self.step, use, self.theta))
        # a mean over about the last hundred samples: the only measure of the noise here
        fresh = self._squares + 0.01 * (error * error - self._squares)
        self._squares = np.where(self.used, fresh, self._squares)
        self.count_samples(self.used, use & ~self.used)
        return error

    @property
    def noise_variance(self) -> Array:
        """Mean square of the recent errors, (shape)."""
        return np.where(self.updates > self.count, self._squares, np.nan)

    @property
    def covariance(self) -> Array:
        """Not known: NaN, (*shape, p, p)."""
        return np.full((*self.shape, self.count, self.count), np.nan)

    def information(self) -> tuple[Array, Array]:
        """Not known: NaN, (shape) each."""
        return np.full(self.shape, np.nan), np.full(self.shape, np.nan)

    def reset(self, mask: Mask | bool = True) -> None:
        """Start again where `mask` (shape) holds."""
        super().reset(mask)
        self._squares = np.where(mask, 0.0, self._squares)
