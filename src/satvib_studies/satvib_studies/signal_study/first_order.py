# SPDX-FileCopyrightText: 2026 The satvib authors
# SPDX-License-Identifier: Apache-2.0
"""The paper's first-order example, Eqs. (1)-(3): y' = -a_p y + k_p r, identified in continuous time from y and r.

The reference r is the sum of a 1 Hz and a slower square wave, held between samples, so the samples of y are exact.
"""

import math
from dataclasses import dataclass

import numpy as np
from satvib_common.arrays import Array
from satvib_ident.estimators.continuous.gradient import GradientEstimator
from satvib_ident.estimators.continuous.least_squares import ContinuousLeastSquares
from satvib_ident.estimators.continuous.regressor import ContinuousRegressor
from satvib_ident.estimators.least_squares import RecursiveLeastSquares
from satvib_ident.forgetting.resetting import CovarianceResetting


@dataclass(frozen=True, eq=False)
class FirstOrderResult:
    """Estimates over time.

    Attributes:
        true: (2) a_p, k_p.
        time: (samples) s.
        traces: by estimator, (samples, 2).
    """

    true: Array
    time: Array
    traces: dict[str, Array]


def first_order_record(a: float, k: float, dt: float, samples: int) -> tuple[Array, Array]:
    """Exact samples of y, and r as held over the period before each, (samples) each."""
    t = np.arange(samples) * dt
    r = np.sign(np.sin(2.0 * np.pi * t + 0.1)) + 0.5 * np.sign(np.sin(2.0 * np.pi * 0.37 * t + 0.2))
    decay = math.exp(-a * dt)
    y = np.zeros(samples)
    for i in range(1, samples):
        y[i] = decay * y[i - 1] + k / a * (1.0 - decay) * r[i]
    return y, r


def run_first_order(
    a: float = 2.0, k: float = 3.0, dt: float = 2e-3, duration: float = 10.0, noise: float = 0.0,
    seed: int = 1,
) -> FirstOrderResult:  # fmt: skip
    """Run the four continuous-time estimators side by side.

    Args:
        a: a_p, 1/s.
        k: k_p.
        dt: s, sample period.
        duration: s.
        noise: deviation of white noise on y.
        seed: of the noise.
    """
    samples = round(duration / dt)
    y, r = first_order_record(a, k, dt, samples)
    y = y + noise * np.random.default_rng([seed, 0]).normal(size=samples)
    estimators: dict[str, RecursiveLeastSquares] = {
        'gradient': GradientEstimator(2, dt, gain=50.0),
        'least squares (16), (17)': ContinuousLeastSquares(2, dt, initial_covariance=100.0),
        'normalized (18)': ContinuousLeastSquares(
            2, dt, gain=10.0, normalization=1.0, initial_covariance=100.0
        ),
        'covariance resetting': ContinuousLeastSquares(
            2, dt, forgetting=CovarianceResetting(0.5, 100.0), initial_covariance=100.0
        ),
    }
    traces = {name: np.empty((samples, 2)) for name in estimators}
    regressor = ContinuousRegressor(1, 1, 5.0, dt)
    for i in range(samples):
        w, target, full = regressor.step(np.asarray(y[i]), np.asarray(r[i]), 0.0)
        for name, estimator in estimators.items():
            estimator.update(w, target, full)
            traces[name][i] = estimator.theta
    time: Array = np.arange(samples, dtype=float) * dt
    return FirstOrderResult(np.array([a, k]), time, traces)
