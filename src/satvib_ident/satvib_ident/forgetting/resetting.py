# SPDX-FileCopyrightText: 2026 The satvib authors
# SPDX-License-Identifier: Apache-2.0
"""Covariance resetting: P <- P_r whenever lambda_min(P) falls below a threshold (the paper, after Eq. 17).

Until then nothing is forgotten. Data make P small, so with lasting excitation the estimator wakes up again and again
and follows a plant that changes; without excitation P does not fall and nothing is reset.
"""

import numpy as np
from numpy.typing import NDArray
from satvib_common.errors import SatvibError

from satvib_ident import ud
from satvib_ident.eigenvalues import smallest_eigenvalue
from satvib_ident.forgetting.none import NoForgetting
from satvib_ident.forgetting.protocol import Factors

Array = NDArray[np.float64]
Mask = NDArray[np.bool_]


class CovarianceResetting(NoForgetting):
    """Reset P to `covariance` (a scalar times the unit matrix) where its smallest eigenvalue is below `threshold`."""

    def __init__(self, threshold: float, covariance: float) -> None:
        if not 0.0 < threshold < covariance:
            raise SatvibError(
                f'reset_threshold: {threshold} is not between 0 and reset_covariance, {covariance}'
            )
        self.threshold, self.covariance = threshold, covariance

    def apply(
        self,
        estimator: Factors,
        w: Array,  # noqa: ARG002
        error: Array,
        active: Mask,
    ) -> tuple[Array | float, Array, Mask]:
        """Reset where it is due."""
        P = ud.covariance(estimator.U, estimator.d)
        low = smallest_eigenvalue(P, enough=self.threshold)
        due = active & (low < self.threshold)
        if due.any():
            estimator.U[...] = np.where(due[..., None, None], np.eye(estimator.count), estimator.U)
            estimator.d[...] = np.where(due[..., None], self.covariance, estimator.d)
        return 1.0, error, active
