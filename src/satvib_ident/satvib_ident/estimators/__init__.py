# SPDX-FileCopyrightText: 2026 The satvib authors
# SPDX-License-Identifier: Apache-2.0
"""Recursive estimators and the regressors that they work on."""

from typing import TYPE_CHECKING

from satvib_common.door import door

if TYPE_CHECKING:
    from satvib_ident.estimators.extended import ExtendedLeastSquares
    from satvib_ident.estimators.factory import make_estimator, make_forgetting, make_regressor
    from satvib_ident.estimators.instrumental import InstrumentalVariable
    from satvib_ident.estimators.least_squares import RecursiveLeastSquares
    from satvib_ident.estimators.regressor import IirRegressor

__all__ = [
    'ExtendedLeastSquares',
    'IirRegressor',
    'InstrumentalVariable',
    'RecursiveLeastSquares',
    'make_estimator',
    'make_forgetting',
    'make_regressor',
]
__getattr__, __dir__ = door(__name__, __file__)
