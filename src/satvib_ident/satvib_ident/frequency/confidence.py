# SPDX-FileCopyrightText: 2026 The satvib authors
# SPDX-License-Identifier: Apache-2.0
"""The disc in which the true frequency response lies with a stated probability.

The error of an estimate from n independent averages with q inputs is complex normal, its variance is estimated from
2 (n - q) real residuals, so |H_est - H|^2 / variance has the distribution F(2, 2 (n - q)). Its quantile is elementary:

    P(F(2, m) > x) = (1 + 2 x / m)^(-m / 2)    =>    x = (m / 2) ((1 - c)^(-2 / m) - 1)

J. S. Bendat and A. G. Piersol, Random Data, 4th edition, 2010, section 9.2 and table 9.6; D. R. Brillinger, Time
Series: Data Analysis and Theory, 1981, section 6.7.
"""

import numpy as np
from numpy.typing import ArrayLike
from satvib_common.arrays import Array


def disc_factor(free: ArrayLike, confidence: float) -> Array:
    """Give the quantile of F(2, 2 `free`), (...); infinite where nothing is free.

    Args:
        free: (...) complex residuals that estimate the variance: averages less inputs.
        confidence: probability.
    """
    n = np.asarray(free, dtype=float)
    with np.errstate(divide='ignore', over='ignore', invalid='ignore'):
        found = n * np.expm1(-np.log1p(-confidence) / n)
    return np.asarray(np.where(n > 0.0, found, np.inf))
