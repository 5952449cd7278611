# SPDX-FileCopyrightText: 2026 The satvib authors
# SPDX-License-Identifier: Apache-2.0
"""Least squares in continuous time, plain and normalized, integrated exactly over a sample.

    theta' = -g P w e1 / (1 + mu w^T P w),   P' = -g P w w^T P / (1 + mu w^T P w)     Eq. (18); (16), (17) for mu =
    0, g = 1

with e1 = w^T theta - y. While w and y stand still, P moves along P w only, so q = w^T P w alone obeys q' = -g q^2 /
(1 + mu q), and s = 1 / q

    s + mu ln s = s(0) + mu ln s(0) + g t

The solution is Eqs. (25)-(27) with the sample weighted by rho = s - s(0), which is g dt for mu = 0: no step size, no
drift of P off symmetry, one implementation. Covariance resetting (after Eq. 17) is the forgetting rule of that name.
"""

import math

import numpy as np
from numpy.typing import ArrayLike
from satvib_common.arrays import Array, Mask
from satvib_common.errors import SatvibError
from satvib_common.kernels.compile import kernel
from satvib_common.kernels.ordered_dot import dot
from satvib_common.kernels.ud import column_product

from satvib_ident.estimators.least_squares import RecursiveLeastSquares
from satvib_ident.forgetting.protocol import Forgetting


@kernel('void(f8[:], f8, f8, f8[:,:], f8[:], f8[:])', '(p),(),(),(p,p),(p)->()')
def _weight(w, step, mu, U, d, rho):
    """Weight of a sample held for a time: step = g dt; mu of the normalization."""
    q = 0.0
    for j in range(d.shape[0]):
        f = column_product(j, U, w)
        q += f * f * d[j]
    rho[0] = step
    if mu <= 0.0 or not 1e-280 < q < 1e280:
        return
    # x = ln(s / s0) solves s0 (exp x - 1) + mu x = step; the left side is convex, so Newton from above runs down to
    # it
    start = 1.0 / q
    x = min(math.log1p(step * q), step / mu)
    for _ in range(60):
        grown = math.expm1(x)
        change = (start * grown + mu * x - step) / (start * (grown + 1.0) + mu)
        x -= change
        if abs(change) <= 1e-15 * x:
            break
    rho[0] = start * math.expm1(x)


class ContinuousLeastSquares(RecursiveLeastSquares):
    """Eqs. (16), (17) or (18) for every item of `shape`.

    Args:
        count: number of parameters p.
        dt: s, sample period.
        shape: leading axes.
        gain: g.
        normalization: mu; 0 for the plain algorithm.
        forgetting: what happens to old data; `CovarianceResetting` is the paper's.
        initial_covariance: P(0) as a scalar or (p) diagonal.
        initial_theta: theta(0), (p).
        limit: largest trace of P that forgetting may reach.
    """

    def __init__(
        self,
        count: int,
        dt: float,
        shape: tuple[int, ...] = (),
        gain: float = 1.0,
        normalization: float = 0.0,
        forgetting: Forgetting | None = None,
        initial_covariance: ArrayLike = 1e18,
        initial_theta: ArrayLike = 0.0,
        limit: float = 0.0,
    ) -> None:
        super().__init__(count, shape, forgetting, initial_covariance, initial_theta, limit)
        if not gain > 0.0 or not normalization >= 0.0:
            raise SatvibError(
                f'continuous least squares: gain {gain} is to be positive, normalization '
                f'{normalization} not negative'
            )
        self.step, self.normalization = gain * dt, normalization

    def update(self, w: Array, y: Array, active: Mask | bool = True) -> Array:
        """Integrate over a sample in which w (*shape, p) and y (shape) stand still; gives -e1 (shape)."""
        error: Array = y - dot(w, self.theta)
        root = np.sqrt(_weight(w, self.step, self.normalization, self.U, self.d))
        self.error_scale = root
        weighted = np.asarray(error * root)
        self.correct(w * root[..., None], weighted, np.isfinite(weighted) & active)
        return error
