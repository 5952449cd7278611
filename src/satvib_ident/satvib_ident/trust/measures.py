# SPDX-FileCopyrightText: 2026 The satvib authors
# SPDX-License-Identifier: Apache-2.0
"""Running measures of excitation and of residuals, over a window of recent samples.

Order of persistent excitation: the largest L for which the covariance of [u(k), u(k-1) ... u(k-L+1)] over the window
is positive definite. The lagged copies are made orthogonal one after the other (modified Gram-Schmidt, twice, which
resolves far more than the covariance itself would); the order ends where nothing is left of a copy. F sines give 2
F, a constant 1, silence 0. A model with n poles and m coefficients needs n + m.

Whiteness: the Ljung-Box statistic Q = N (N + 2) sum_{j=1..h} r_j^2 / (N - j) of the residual's autocorrelations r_j
over h; for a white residual Q is chi-squared with h degrees of freedom, so Q / h is about 1.

G. M. Ljung and G. E. P. Box, On a measure of lack of fit in time series models, Biometrika 65, 1978.
"""

import numpy as np
from satvib_common.arrays import Array, Mask
from satvib_common.kernels.compile import kernel
from satvib_common.kernels.deferred import njit

from satvib_ident.trust.recent import Recent, RecentSamples, latest, move_on, put

# What orthogonalization leaves below this share of the power is rounding; 1 Hz and 2 Hz sines at 1 kHz leave 2e-13.
REST = 1e-24


@kernel('void(f8, b1, f8[:], f8[:], f8[:])', '(),(),(v),(s)->()', writable=('ring', 'state'))
def _push(value, active, ring, state, held):
    """Put a value into a ring where `active` holds."""
    if active:
        put(value, ring, state)
        move_on(ring.shape[0] // 2, state)
    held[0] = state[Recent.HELD]


@njit
def _products(x, first, sums):
    """Sums over k >= first of x(k) x(k - j), j = 0..; k - j may reach back before `first`, not before 0."""
    lags = sums.shape[0]
    for j in range(lags):
        sums[j] = 0.0
    for k in range(first, x.shape[0]):
        value = x[k]
        for j in range(lags):
            sums[j] += value * x[k - j]


@kernel('void(f8[:], f8[:], f8, f8[:])', '(v),(s),()->()')
def _order(ring, state, most, out):
    held = int(state[Recent.HELD])
    limit = min(int(most), held // 2)
    out[0] = 0.0
    if limit == 0:
        return
    x = latest(ring, state)
    rows = held - limit + 1
    columns = np.empty((limit, rows))
    power = 0.0
    for j in range(limit):
        for k in range(rows):
            columns[j, k] = x[limit - 1 - j + k]
        for _ in range(2):  # once more takes out what rounding has left of the others
            for i in range(j):
                share = 0.0
                for k in range(rows):
                    share += columns[i, k] * columns[j, k]
                for k in range(rows):
                    columns[j, k] -= share * columns[i, k]
        left = 0.0
        for k in range(rows):
            left += columns[j, k] * columns[j, k]
        if j == 0:
            power = left
            if not 1e-200 < power < 1e200:
                return
        if not left > REST * power:
            return
        out[0] = j + 1.0
        root = np.sqrt(left)
        for k in range(rows):
            columns[j, k] /= root


@kernel('void(f8[:], f8[:], f8[:], f8[:], f8[:])', '(v),(s),(l)->(l),()')
def _whiteness(ring, state, like, sums, out):
    held = int(state[Recent.HELD])
    lags = like.shape[0] - 1
    out[0] = np.nan
    if held < 3 * lags:
        return
    x = latest(ring, state)
    _products(x, lags, sums)
    for k in range(lags):  # the first samples have fewer lags
        for j in range(k + 1):
            sums[j] += x[k] * x[k - j]
    if not 1e-250 < sums[0] < 1e250:
        return
    q = 0.0
    for j in range(1, lags + 1):
        r = sums[j] / sums[0]
        q += r * r / (held - j)
    out[0] = held * (held + 2.0) * q / lags


class RecentSignal(RecentSamples):
    """The last `window` values of a signal, per item of `shape`.

    Args:
        window: samples.
        shape: leading axes.
    """

    def __init__(self, window: int, shape: tuple[int, ...] = ()) -> None:
        super().__init__(shape)
        self._ring = np.zeros((*shape, 2 * window))

    def push(self, value: Array, active: Mask | bool = True) -> None:
        """Take a value (shape) where `active` (shape) holds; finite there."""
        _push(value, active, self._ring, self._state)

    def excitation_order(self, limit: int) -> Array:
        """Order of persistent excitation, (shape); no more than `limit`, nor than half the samples held."""
        return np.asarray(_order(self._ring, self._state, float(limit)))

    def whiteness(self, lags: int) -> Array:
        """Ljung-Box statistic over `lags`, divided by it, (shape); NaN with fewer than 3 lags samples or no power."""
        _, statistic = _whiteness(self._ring, self._state, np.zeros(lags + 1))
        return np.asarray(statistic)
