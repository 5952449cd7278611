# SPDX-FileCopyrightText: 2026 The satvib authors
# SPDX-License-Identifier: Apache-2.0
"""Regressors, estimators and forgetting rules by the names that the parameters use."""

import math

from satvib_ident.estimators.continuous.gradient import GradientEstimator
from satvib_ident.estimators.continuous.least_squares import ContinuousLeastSquares
from satvib_ident.estimators.continuous.regressor import ContinuousRegressor
from satvib_ident.estimators.extended import ExtendedLeastSquares
from satvib_ident.estimators.instrumental import InstrumentalVariable
from satvib_ident.estimators.least_squares import RecursiveLeastSquares
from satvib_ident.estimators.regressor import IirRegressor
from satvib_ident.forgetting.dead_zone import DeadZone
from satvib_ident.forgetting.directional import DirectionalForgetting
from satvib_ident.forgetting.exponential import ExponentialForgetting
from satvib_ident.forgetting.none import NoForgetting
from satvib_ident.forgetting.protocol import Forgetting
from satvib_ident.forgetting.resetting import CovarianceResetting
from satvib_ident.forgetting.variable_rate import VariableRateForgetting
from satvib_ident.forgetting.window import FiniteWindow
from satvib_ident.parameters import IdentifierParameters


def make_forgetting(parameters: IdentifierParameters) -> Forgetting:
    """Make the forgetting rule of an identifier; a rule belongs to one estimator."""
    p = parameters
    test = VariableRateForgetting(
        p.short_window, p.long_window, p.confidence, p.forgetting_rate,
        p.forgetting_smallest, p.error_floor,
    )  # fmt: skip
    match p.forgetting:
        case 'exponential':
            return ExponentialForgetting(p.forgetting_factor)
        case 'variable_rate':
            return test
        case 'directional':
            return DirectionalForgetting(
                p.forgetting_factor, p.regressor_floor, float(p.short_window), test
            )
        case 'resetting':
            return CovarianceResetting(p.reset_threshold, p.reset_covariance)
        case 'dead_zone':
            return DeadZone(p.dead_zone)
        case 'window':
            return FiniteWindow(p.window)
        case _:
            return NoForgetting()


def make_estimator(
    parameters: IdentifierParameters, shape: tuple[int, ...]
) -> RecursiveLeastSquares:
    """Make the estimator of an identifier for every item of `shape`."""
    p = parameters
    rule = make_forgetting(p)
    start = p.initial_theta or 0.0
    prior = (p.initial_covariance, start, p.covariance_limit)
    if p.estimator == 'extended':
        return ExtendedLeastSquares(p.count, p.noise_coefficients, shape, rule, *prior)
    if p.estimator == 'instrumental':
        return InstrumentalVariable(
            p.poles, p.coefficients, p.noise_coefficients, shape, rule, *prior
        )
    if p.estimator == 'continuous_gradient':
        return GradientEstimator(p.count, p.dt, shape, p.gain, start)
    if p.estimator.startswith('continuous'):
        normalization = p.normalization if p.estimator == 'continuous_normalized' else 0.0
        return ContinuousLeastSquares(p.count, p.dt, shape, p.gain, normalization, rule, *prior)
    return RecursiveLeastSquares(p.count, shape, rule, *prior)


def make_regressor(
    parameters: IdentifierParameters, shape: tuple[int, ...]
) -> IirRegressor | ContinuousRegressor:
    """Make what turns samples into regressions, and estimates into models, for every item of `shape`."""
    p = parameters
    if p.estimator.startswith('continuous'):
        unit = 1.0 / (2.0 * math.pi * p.filter_corner)
        return ContinuousRegressor(p.poles, p.coefficients, p.filter_corner, p.dt, shape, unit)
    return IirRegressor(p.poles, p.coefficients, p.delay, shape)
