# SPDX-FileCopyrightText: 2026 The satvib authors
# SPDX-License-Identifier: Apache-2.0
"""What a model says of a record: one-step predictions, and a free run that starts again behind every gap.

A fit is 1 - |y - yhat| / |y - mean y|, over the samples at which there is a yhat.
"""

from dataclasses import dataclass

import numpy as np
from satvib_common.arrays import Array
from satvib_common.kernels.compile import kernel

RUNS_AWAY = 1e6  # deviations of the record: a free run beyond this has run away


@kernel('void(f8[:], f8[:], f8, i8, f8[:], f8[:], f8[:], f8[:])', '(n),(m),(),(),(t),(t)->(t),(t)')
def _follow(a, b, constant, delay, y, u, predicted, free):
    """One-step predictions and a free run; NaN where there is none.

    The free run needs n measured outputs to start from, and starts anew where the input is not known.
    """
    n, m = a.shape[0], b.shape[0]
    past = np.zeros(n)
    have = 0
    running = False
    for k in range(y.shape[0]):
        driven = constant
        reach = k - delay - m + 1
        known = reach >= 0
        if known:
            for i in range(m):
                driven += b[i] * u[k - delay - i]
            known = driven == driven
        predicted[k] = np.nan
        if known and k >= n:
            total = driven
            for i in range(n):
                total -= a[i] * y[k - 1 - i]
            predicted[k] = total
        free[k] = np.nan
        if known and have >= n:
            running = True
            value = driven
            for i in range(n):
                value -= a[i] * past[i]
            value = min(max(value, -1e150), 1e150)
            free[k] = value
        else:
            if running:
                have = 0
            running = False
            value = y[k]
            have = have + 1 if value == value else 0
        for i in range(n - 1, 0, -1):
            past[i] = past[i - 1]
        past[0] = value


@kernel('void(f8[:], f8[:], f8[:])', '(t),(t)->()')
def _fit(y, modelled, out):
    count, mean = 0, 0.0
    for k in range(y.shape[0]):
        if abs(y[k]) < np.inf and modelled[k] == modelled[k]:
            count += 1
            mean += (y[k] - mean) / count
    out[0] = np.nan
    if count < 2:
        return
    spread, off, peak = 0.0, 0.0, 0.0
    for k in range(y.shape[0]):
        if abs(y[k]) < np.inf and modelled[k] == modelled[k]:
            spread += (y[k] - mean) ** 2
            off += (y[k] - modelled[k]) ** 2
            peak = max(peak, abs(modelled[k]))
    spread = np.sqrt(spread)
    if spread > 0.0 and peak < RUNS_AWAY * spread:
        out[0] = 1.0 - np.sqrt(off) / spread
    else:
        out[0] = -np.inf


@dataclass(frozen=True, eq=False)
class Fitted:
    """A difference equation A(q) y = B(q) u(k - delay) + constant and what it says of a record.

    Attributes:
        one_step, free_run: fits; -inf where the model runs away, NaN where there is nothing to compare.
        predicted, free: (samples) NaN where there is none.
    """

    one_step: float
    free_run: float
    predicted: Array
    free: Array


def fit(y: Array, modelled: Array) -> float:
    """Fit over the samples at which both are known; -inf where the model has run away, NaN without samples."""
    return float(_fit(y, modelled))


def follow(a: Array, b: Array, constant: float, delay: int, y: Array, u: Array) -> Fitted:
    """Run a model along a record (samples), NaN where it has gaps."""
    with np.errstate(over='ignore', invalid='ignore'):
        predicted, free = _follow(a, b, constant, delay, y, u)
    return Fitted(fit(y, predicted), fit(y, free), predicted, free)
