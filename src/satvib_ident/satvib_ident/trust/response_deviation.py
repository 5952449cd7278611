# SPDX-FileCopyrightText: 2026 The satvib authors
# SPDX-License-Identifier: Apache-2.0
"""How well a model's frequency response is known in a band.

To first order in the parameters, with G = B / A and z = exp(j 2 pi f dt),

    dG/da_i = -G z^-i / A,   dG/db_i = z^-(i-1) / A,   E |dG|^2 = Re J C J* ^T

with J the row of derivatives and C the covariance of the parameters. The measure is the largest sqrt(E |dG|^2) / |G|
over a grid of frequencies: a loop with modulus margin 0.5 survives a relative error of 0.5 wherever its own gain is
at most 1, so a value of 0.25 leaves two deviations.
"""

import math

import numpy as np
from satvib_common.arrays import Array
from satvib_common.errors import SatvibError
from satvib_common.kernels.compile import kernel


@kernel(
    'void(f8[:], f8[:,:], f8[:,:], f8[:,:], i8, i8, f8[:], f8[:])',
    '(p),(p,p),(f,l),(f,l),(),()->(f),()',
)
def _deviation(theta, covariance, cosine, sine, n, m, each, out):
    """Deviation at each frequency, and the largest, of a model of n poles and m coefficients."""
    worst = 0.0
    for g in range(cosine.shape[0]):
        # A and B at z = exp(j w): z^-i = cos - j sin
        ar, ai, br, bi = 1.0, 0.0, 0.0, 0.0
        for i in range(n):
            ar += theta[i] * cosine[g, i + 1]
            ai -= theta[i] * sine[g, i + 1]
        for i in range(m):
            br += theta[n + i] * cosine[g, i]
            bi -= theta[n + i] * sine[g, i]
        size = ar * ar + ai * ai
        if not 1e-200 < size < 1e200 or not br * br + bi * bi < 1e200:
            each[g] = np.inf
            worst = np.inf
            continue
        gr = (br * ar + bi * ai) / size
        gi = (bi * ar - br * ai) / size
        # derivatives times A, so that one division is left
        total = 0.0
        for i in range(n + m):
            if i < n:
                xr = -(gr * cosine[g, i + 1] + gi * sine[g, i + 1])
                xi = -(gi * cosine[g, i + 1] - gr * sine[g, i + 1])
            else:
                xr = cosine[g, i - n]
                xi = -sine[g, i - n]
            for j in range(n + m):
                if j < n:
                    yr = -(gr * cosine[g, j + 1] + gi * sine[g, j + 1])
                    yi = -(gi * cosine[g, j + 1] - gr * sine[g, j + 1])
                else:
                    yr = cosine[g, j - n]
                    yi = -sine[g, j - n]
                total += (xr * yr + xi * yi) * covariance[i, j]
        gain = gr * gr + gi * gi
        if total >= 0.0 and gain > 1e-200:
            each[g] = np.sqrt(total / size / gain)
        else:
            each[g] = np.inf
        if not each[g] <= worst:
            worst = each[g]
    out[0] = worst


class ResponseDeviation:
    """The measure for one band.

    Args:
        band: Hz, lowest and highest frequency.
        dt: s, sample period.
        poles: n.
        coefficients: m.
        points: frequencies, spaced evenly in logarithm.

    Raises:
        SatvibError: a band that is empty or reaches half the sample rate.
    """

    def __init__(
        self, band: tuple[float, float], dt: float, poles: int, coefficients: int, points: int = 8
    ) -> None:
        low, high = band
        if not 0.0 < low <= high or high * dt >= 0.5:
            raise SatvibError(
                f'trust_band: {low} to {high} Hz; 0 < low <= high < {0.5 / dt:g} Hz (half the sample '
                'rate) is needed'
            )
        self.frequencies = np.geomspace(low, high, points)
        lags = max(poles + 1, coefficients)
        turns = 2.0 * math.pi * dt * self.frequencies[:, None] * np.arange(lags)
        self._cosine, self._sine = np.cos(turns), np.sin(turns)
        self._poles, self._coefficients = poles, coefficients

    def __call__(self, theta: Array, covariance: Array) -> Array:
        """Largest relative deviation in the band, (...), of theta (..., p) with covariance (..., p, p)."""
        _, worst = _deviation(
            theta, covariance, self._cosine, self._sine, self._poles, self._coefficients
        )
        return np.asarray(worst)
