# SPDX-FileCopyrightText: 2026 The satvib authors
# SPDX-License-Identifier: Apache-2.0
"""Covariance resetting: P <- P_r whenever lambda_min(P) falls below a threshold (the paper, after Eq. 17).

Until then nothing is forgotten. Data make P small, so with lasting excitation P is reset again and again and the
estimator follows a plant that changes; without excitation P does not fall and nothing is reset.

The test is made on the information matrix R = P^-1: lambda_min(P) < threshold where R - 1/threshold is not negative
definite, which symmetric elimination decides. On P itself, rounding of the large eigenvalues that it begins with
would hide the small one. As long as the trace of R is below 1/threshold there is nothing to test.
"""

import numpy as np
from satvib_common.arrays import Array, Mask
from satvib_common.errors import SatvibError
from satvib_common.kernels.compile import kernel

from satvib_ident.covariance.eigenvalues import is_positive
from satvib_ident.forgetting.none import ONE, NoForgetting
from satvib_ident.forgetting.protocol import Factors


@kernel(
    'void(b1, f8, f8, f8[:,:], f8[:], f8[:,:], b1[:])',
    '(),(),(),(p,p),(p),(p,p)->()',
    writable=('U', 'd'),
)
def _reset(active, threshold, covariance, U, d, work, due):
    """Reset (U, d) where lambda_min is below the threshold; `work`, one for all items, is for the kernel alone."""
    p = d.shape[0]
    due[0] = False
    if not active:
        return
    trace = 0.0
    for j in range(p):  # below the diagonal, transposed: U^-1; the diagonal: d^-1
        work[j, j] = 1.0 / d[j]
    for j in range(p):
        trace += work[j, j]
        for i in range(j - 1, -1, -1):
            total = U[i, j]
            for k in range(i + 1, j):
                total += U[i, k] * work[j, k]
            work[j, i] = -total
            trace += total * total * work[i, i]
    top = 1.0 / threshold
    if trace <= top:
        return
    for j in range(p):  # above the diagonal, from below: -R
        for i in range(j):
            total = work[j, i] * work[i, i]
            for k in range(i):
                total += work[i, k] * work[k, k] * work[j, k]
            work[i, j] = -total
    for j in range(p - 1, -1, -1):
        total = work[j, j]
        for k in range(j):
            total += work[j, k] * work[k, k] * work[j, k]
        work[j, j] = top - total
    due[0] = not is_positive(work, 0.0)
    if due[0]:
        for j in range(p):
            d[j] = covariance
            for i in range(j):
                U[i, j] = 0.0


class CovarianceResetting(NoForgetting):
    """Reset P to `covariance` (a scalar times the unit matrix) where its smallest eigenvalue is below `threshold`."""

    def __init__(self, threshold: float, covariance: float) -> None:
        if not 0.0 < threshold < covariance:
            raise SatvibError(
                f'reset_threshold: {threshold} is not between 0 and reset_covariance, {covariance}'
            )
        self.threshold, self.covariance = threshold, covariance
        self._threshold, self._covariance = np.asarray(threshold), np.asarray(covariance)

    def bind(self, estimator: Factors) -> None:
        """Make room for the test."""
        self._work = np.zeros((estimator.count, estimator.count))

    def apply(
        self,
        estimator: Factors,
        w: Array,  # noqa: ARG002
        error: Array,
        active: Mask,
    ) -> tuple[Array, Array, Mask]:
        """Reset where it is due."""
        _reset(
            active, self._threshold, self._covariance, estimator.U, estimator.d, self._work,
        )  # fmt: skip
        return ONE, error, active
