# SPDX-FileCopyrightText: 2026 The satvib authors
# SPDX-License-Identifier: Apache-2.0
"""Estimators and forgetting rules by the names that the parameters use."""

from satvib_ident.forgetting import ExponentialForgetting, Forgetting, NoForgetting
from satvib_ident.parameters import IdentifierParameters
from satvib_ident.recursive_least_squares import RecursiveLeastSquares


def make_forgetting(parameters: IdentifierParameters) -> Forgetting:
    """Make the forgetting rule of an identifier."""
    if parameters.forgetting == 'exponential':
        return ExponentialForgetting(parameters.forgetting_factor)
    return NoForgetting()


def make_estimator(
    parameters: IdentifierParameters, shape: tuple[int, ...]
) -> RecursiveLeastSquares:
    """Make the estimator of an identifier for every item of `shape`."""
    return RecursiveLeastSquares(
        parameters.count,
        shape,
        make_forgetting(parameters),
        parameters.initial_covariance,
        parameters.initial_theta or 0.0,
        parameters.covariance_limit,
    )
