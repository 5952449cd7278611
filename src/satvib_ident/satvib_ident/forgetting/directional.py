# SPDX-FileCopyrightText: 2026 The satvib authors
# SPDX-License-Identifier: Apache-2.0
"""Directional forgetting: forget only where new data come in (subspace of information forgetting).

With R = P^-1, before the measurement and for |w| >= epsilon:

    R <- R - (1 - lambda) R w w^T R / (w^T R w)     that is     P <- P + (1/lambda - 1) w w^T / (w^T R w)

What w does not reach is kept for ever, so P stays bounded without any excitation. A regressor shorter than epsilon
carries no information worth the name: it is left out altogether (the information filter), else noise alone would
gnaw at what is known.

L. Cao and H. Schwartz, A directional forgetting algorithm based on the decomposition of the information matrix,
Automatica 36, 2000; B. Lai and D. S. Bernstein, SIFt-RLS, arXiv:2404.10844, 2024 (bounds on P without excitation).
"""

import numpy as np
from numpy.typing import NDArray
from satvib_common.errors import SatvibError

from satvib_ident import ud
from satvib_ident.forgetting.exponential import checked_factor
from satvib_ident.forgetting.none import NoForgetting
from satvib_ident.forgetting.protocol import Factors

Array = NDArray[np.float64]
Mask = NDArray[np.bool_]


class DirectionalForgetting(NoForgetting):
    """Forget with `factor` in (0, 1] along the regressor; leave regressors shorter than `floor` out."""

    def __init__(self, factor: float, floor: float = 0.0) -> None:
        self.factor = checked_factor(factor)
        if not floor >= 0.0:
            raise SatvibError(f'regressor_floor: {floor} is negative')
        self._floor = floor * floor

    def apply(
        self,
        estimator: Factors,
        w: Array,
        error: Array,
        active: Mask,
    ) -> tuple[Array | float, Array, Mask]:
        """Forget along w."""
        active = active & (ud.dot(w, w) >= self._floor)
        ud.forget_along(w, self.factor, estimator.limit, active, estimator.U, estimator.d)
        return 1.0, error, active
