# SPDX-FileCopyrightText: 2026 The satvib authors
# SPDX-License-Identifier: Apache-2.0
"""Identification in continuous time: the paper's sections 1 and 2."""

from typing import TYPE_CHECKING

from satvib_common.door import door

if TYPE_CHECKING:
    from satvib_ident.estimators.continuous.gradient import GradientEstimator
    from satvib_ident.estimators.continuous.least_squares import ContinuousLeastSquares
    from satvib_ident.estimators.continuous.regressor import ContinuousRegressor

__all__ = [
    'ContinuousLeastSquares',
    'ContinuousRegressor',
    'GradientEstimator',
]
__getattr__, __dir__ = door(__name__, __file__)
