# SPDX-FileCopyrightText: 2026 The satvib authors
# SPDX-License-Identifier: Apache-2.0
"""Tests on the residual of a model over a whole record: is it white, and is it independent of the input?

    r_e(j) = sum e(k) e(k-j) / sum e^2,     r_eu(j) = sum e(k) u(k-j) / sqrt(sum e^2 sum u^2)

A white residual of N samples has r_e within 2.58 / sqrt(N) for 99 % of the lags, and the Ljung-Box statistic is
chi-squared. A residual that owes nothing to the input has r_eu within 2.58 sqrt(sum_j r_e(j) r_u(j) / N), whatever
its own colour. Samples that are missing count as zero.

L. Ljung, System Identification, 1999, section 16.6.
"""

from dataclasses import dataclass

import numpy as np
from satvib_common.arrays import Array, Mask
from scipy.fft import irfft, next_fast_len, rfft
from scipy.special import chdtrc

NINETY_NINE = 2.5758293035489004


@dataclass(frozen=True, eq=False)
class ResidualTests:
    """Correlations of a residual.

    Attributes:
        auto: (lags + 1) r_e(0..lags).
        auto_bound: 99 % bound of r_e(1..).
        cross: (2 lags + 1) r_eu(-lags..lags); positive lags: the residual after the input.
        cross_bound: 99 % bound.
        ljung_box: Q over `lags` lags.
        p_value: probability of a larger Q if the residual were white.
        independent_share: share of the lags 0..lags at which r_eu is within its bound.
    """

    auto: Array
    auto_bound: float
    cross: Array
    cross_bound: float
    ljung_box: float
    p_value: float
    independent_share: float

    @property
    def lags(self) -> int:
        """Largest lag."""
        return len(self.auto) - 1


def correlation(a: Array, b: Array, lags: int) -> Array:
    """Sums of a(k) b(k - j), j = 0..lags."""
    if lags <= 30:
        return np.array([float(a[j:] @ b[: len(b) - j]) for j in range(lags + 1)])
    size = next_fast_len(len(a) + lags, real=True)
    return irfft(rfft(a, size) * np.conj(rfft(b, size)), size)[: lags + 1]


def centred(values: Array, known: Mask) -> Array:
    """Take the mean of what is known off a signal (samples), and put zero where it is not known."""
    return np.where(known, values - values[known].mean(), 0.0)


def residual_tests(residual: Array, u: Array, lags: int = 20) -> ResidualTests:
    """Test a residual (samples) against itself and the input (samples); NaN where a sample is missing."""
    known = np.isfinite(residual) & np.isfinite(u)
    count = max(int(known.sum()), 1)
    e, u = centred(residual, known), centred(u, known)
    lags = max(min(lags, count // 4), 1)
    power_e, power_u = float(e @ e), float(u @ u)
    auto = correlation(e, e, lags) / (power_e or 1.0)
    q = count * (count + 2.0) * float(np.sum(auto[1:] ** 2 / (count - np.arange(1, lags + 1))))
    after, before = correlation(e, u, lags), correlation(u, e, lags)
    cross = np.concatenate([before[:0:-1], after]) / (np.sqrt(power_e * power_u) or 1.0)
    own = correlation(u, u, lags) / (power_u or 1.0)
    # noise in the products can make the sum negative for a short record
    spread = max(1.0 + 2.0 * float(auto[1:] @ own[1:]), 1e-3)
    bound = NINETY_NINE * float(np.sqrt(spread / count))
    return ResidualTests(
        auto=auto,
        auto_bound=NINETY_NINE / float(np.sqrt(count)),
        cross=cross,
        cross_bound=bound,
        ljung_box=q,
        p_value=float(chdtrc(lags, q)),
        independent_share=float(np.mean(np.abs(cross[lags:]) <= bound)),
    )
