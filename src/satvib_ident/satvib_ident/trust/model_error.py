# SPDX-FileCopyrightText: 2026 The satvib authors
# SPDX-License-Identifier: Apache-2.0
"""The error of a model's response, from what its residual still has in common with the input.

The residual of the present model over the recent samples, e = A y - B u, is A (G0 - G) u and noise. A short filter H
is fitted from u to e by least squares with a slight ridge; then G0 - G is about H / A, and relative to G = B / A

    |G0 - G| / |G| ~ |H| / |B|

whatever the colour of the noise. It shows what a covariance cannot: an order too low, a wrong delay, bias from noise,
an actuator that saturates. Noise adds about sqrt(lags / N) times the ratio of noise to response.

Where the input has no power H is not known, and the ridge makes it 0. Therefore the deviation of H itself is checked:
with s^2 the variance of what H leaves of e, and c the row of exp(-j 2 pi f i dt),

    E |dH|^2 = s^2 c (R + ridge)^-1 c*

If that exceeds half of |B|^2 anywhere in the band, an error as large as the response could hide there, and the answer
is infinity.

L. Ljung, Model error modeling and control design, IFAC SYSID 2000.
"""

import math

import numpy as np
from satvib_common.arrays import Array, Mask
from satvib_common.kernels.compile import kernel

from satvib_ident.trust.recent import Recent, RecentSamples, latest, move_on, put

RIDGE = 1e-3
HIDDEN = 0.5  # share of |G|^2 that noise may hide


@kernel(
    'void(f8, f8, b1, f8[:,:], f8[:], f8[:])', '(),(),(),(t,v),(s)->()', writable=('ring', 'state')
)
def _push(y, u, active, ring, state, held):
    """Put a pair into the rings of y and u where `active` holds."""
    if active:
        put(y, ring[0], state)
        put(u, ring[1], state)
        move_on(ring.shape[1] // 2, state)
    held[0] = state[Recent.HELD]


@kernel(
    'void(f8[:], f8[:,:], f8[:], f8[:,:], f8[:,:], i8, i8, f8[:,:], f8[:,:], f8[:], f8[:])',
    '(p),(t,v),(s),(f,l),(f,l),(),(),(l,l),(t,l)->(l),()',
    writable=('R',),
)
def _error(theta, ring, state, cosine, sine, n, m, R, work, h, out):
    """Largest |H| / |B| over the frequencies of one item, for a model of n poles and m coefficients."""
    lags = R.shape[0]
    held = int(state[Recent.HELD])
    y = latest(ring[0], state)
    u = latest(ring[1], state)
    first = max(n, max(m, lags) - 1)
    out[0] = np.nan
    for i in range(lags):
        h[i] = 0.0
        for j in range(lags):
            R[i, j] = 0.0
    if held < first + 3 * lags:
        return
    left = 0.0
    for k in range(first, held):
        e = y[k]
        for i in range(n):
            e += theta[i] * y[k - 1 - i]
        for i in range(m):
            e -= theta[n + i] * u[k - i]
        now = u[k]
        left += e * e
        for j in range(lags):
            h[j] += e * u[k - j]
            R[0, j] += now * u[k - j]
    for i in range(1, lags):
        for j in range(i, lags):
            R[i, j] = R[i - 1, j - 1] + u[first - i] * u[first - j] - u[held - i] * u[held - j]
    power = R[0, 0]
    if not 1e-250 < power < 1e250:
        return
    for i in range(lags):  # Cholesky factor, forward substitution
        pivot = R[i, i] + RIDGE * power
        for k in range(i):
            pivot -= R[k, i] * R[k, i]
        root = np.sqrt(max(pivot, 1e-12 * power))
        R[i, i] = root
        for k in range(i):
            h[i] -= R[k, i] * h[k]
        h[i] /= root
        left -= h[i] * h[i]
        for j in range(i + 1, lags):
            total = R[i, j]
            for k in range(i):
                total -= R[k, i] * R[k, j]
            R[i, j] = total / root
    for i in range(lags - 1, -1, -1):
        for j in range(i + 1, lags):
            h[i] -= R[i, j] * h[j]
        h[i] /= R[i, i]
    variance = max(left, 0.0) / (held - first)
    x, z = work[0], work[1]
    top = 0.0
    for g in range(cosine.shape[0]):
        hr, hi, br, bi = 0.0, 0.0, 0.0, 0.0
        for i in range(lags):
            hr += h[i] * cosine[g, i]
            hi -= h[i] * sine[g, i]
        for i in range(m):
            br += theta[n + i] * cosine[g, i]
            bi -= theta[n + i] * sine[g, i]
        size_h = hr * hr + hi * hi
        size_b = br * br + bi * bi
        if not size_b > 1e-200 or not size_h < 1e200:
            out[0] = np.inf
            return
        top = max(top, size_h / size_b)
        spread = 0.0
        for i in range(lags):  # forward substitution of c
            x[i] = cosine[g, i]
            z[i] = sine[g, i]
            for k in range(i):
                x[i] -= R[k, i] * x[k]
                z[i] -= R[k, i] * z[k]
            x[i] /= R[i, i]
            z[i] /= R[i, i]
            spread += x[i] * x[i] + z[i] * z[i]
        if variance * spread > HIDDEN * size_b:
            out[0] = np.inf
            return
    out[0] = np.sqrt(top)


class ModelError(RecentSamples):
    """The recent samples, and the measure for one band.

    Args:
        frequencies: Hz, (f).
        dt: s, sample period.
        poles: n.
        coefficients: m.
        window: samples looked at.
        lags: length of H; too few do not reach what rings on.
        shape: leading axes.
    """

    def __init__(
        self,
        frequencies: Array,
        dt: float,
        poles: int,
        coefficients: int,
        window: int,
        lags: int = 20,
        shape: tuple[int, ...] = (),
    ) -> None:
        self._lags = lags
        turns = 2.0 * math.pi * dt * frequencies[:, None] * np.arange(self._lags)
        self._cosine, self._sine = np.cos(turns), np.sin(turns)
        super().__init__(shape)
        self._poles, self._coefficients = poles, coefficients
        self._ring = np.zeros((*shape, 2, 2 * window))
        self._shape = shape

    def push(self, y: Array, u: Array, active: Mask) -> None:
        """Take y(k) and u(k - d), both (shape) and finite where `active` (shape) holds."""
        _push(y, u, active, self._ring, self._state)

    def __call__(self, theta: Array) -> Array:
        """Largest |G0 - G| / |G| in the band, (shape), of theta (*shape, p).

        NaN with too few samples, infinite where the input has too little power.
        """
        work = np.zeros((*self._shape, self._lags, self._lags))
        _, worst = _error(
            theta, self._ring, self._state, self._cosine, self._sine, self._poles,
            self._coefficients, work, np.zeros((2, self._lags)),
        )  # fmt: skip
        return np.asarray(worst)
