# SPDX-FileCopyrightText: 2026 The satvib authors
# SPDX-License-Identifier: Apache-2.0
"""No forgetting: lambda = 1, every sample counts alike; the batch least-squares solution of Eq. (8)."""

import numpy as np
from satvib_common.arrays import Array, Mask

from satvib_ident.forgetting.protocol import Factors

ONE: Array = np.ones(())


class NoForgetting:
    """lambda = 1. Also the base of the other rules: it has nothing to bind and nothing to reset."""

    def bind(self, estimator: Factors) -> None:
        """Nothing to prepare."""

    def apply(
        self,
        estimator: Factors,  # noqa: ARG002
        w: Array,  # noqa: ARG002
        error: Array,
        active: Mask,
    ) -> tuple[Array, Array, Mask]:
        """Leave everything as it is."""
        return ONE, error, active

    def know_noise(self, deviation: Array) -> None:
        """Nothing depends on the noise."""

    def reset(self, mask: Mask) -> None:
        """Nothing to forget."""
