# SPDX-FileCopyrightText: 2026 The satvib authors
# SPDX-License-Identifier: Apache-2.0
"""Exponential forgetting: a sample that is j samples old weighs lambda^j.

    P <- P / lambda     before each measurement

Without excitation P grows as lambda^-k in the directions that the data do not reach (wind-up); the estimator's limit
on the trace of P stops the growth, and the estimate then follows the noise. Use it only while the excitation lasts.
"""

import numpy as np
from satvib_common.arrays import Array, Mask
from satvib_common.errors import SatvibError

from satvib_ident.forgetting.none import NoForgetting
from satvib_ident.forgetting.protocol import Factors


def checked_factor(factor: float) -> float:
    """Give a forgetting factor back if it lies in (0, 1]; raises SatvibError."""
    if not 0.0 < factor <= 1.0:
        raise SatvibError(f'forgetting_factor: {factor} is not in (0, 1]')
    return factor


class ExponentialForgetting(NoForgetting):
    """One lambda for all time; `factor` in (0, 1]."""

    def __init__(self, factor: float) -> None:
        self.factor = checked_factor(factor)
        self._factor = np.asarray(self.factor)

    def apply(
        self,
        estimator: Factors,  # noqa: ARG002
        w: Array,  # noqa: ARG002
        error: Array,
        active: Mask,
    ) -> tuple[Array, Array, Mask]:
        """Forget at the fixed rate."""
        return self._factor, error, active
