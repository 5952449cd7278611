# SPDX-FileCopyrightText: 2026 The satvib authors
# SPDX-License-Identifier: Apache-2.0
"""Running measures of excitation and of residuals, over a window of recent samples.

Order of persistent excitation: the largest L for which the covariance of [u(k), u(k-1) ... u(k-L+1)] over the window
is positive definite, by its Cholesky pivots: pivot L is the share of u(k-L+1) that the others do not already tell. F
sines give 2 F, a constant 1, silence 0. A model with n poles and m coefficients needs n + m.

Whiteness: the Ljung-Box statistic Q = N (N + 2) sum_{j=1..h} r_j^2 / (N - j) of the residual's autocorrelations r_j
over h; for a white residual Q is chi-squared with h degrees of freedom, so Q / h is about 1.

G. M. Ljung and G. E. P. Box, On a measure of lack of fit in time series models, Biometrika 65, 1978.
"""

import numpy as np
from numpy.typing import NDArray
from satvib_common.kernel import kernel

Array = NDArray[np.float64]
Mask = NDArray[np.bool_]

# A pivot below this share of the signal's power is rounding: 1 Hz and 2 Hz sines at 100 Hz have a last pivot of 1e-8.
PIVOT = 1e-11


@kernel('void(f8, b1, f8[:], f8[:])', '(),(),(w),(s)', writable=('ring', 'state'))
def _push(value, active, ring, state):  # type: ignore[no-untyped-def]  # noqa: ANN001, ANN202
    """Put a value into a ring; `state` is the number held and the next place."""
    if active:
        place = int(state[1])
        ring[place] = value
        state[0] = min(state[0] + 1.0, ring.shape[0])
        state[1] = (place + 1) % ring.shape[0]


@kernel('void(f8[:], f8[:], f8[:,:], f8[:])', '(w),(s),(l,l)->()', writable=('work',))
def _order(ring, state, work, out):  # type: ignore[no-untyped-def]  # noqa: ANN001, ANN202
    size = ring.shape[0]
    held = int(state[0])
    start = int(state[1]) - held
    limit = work.shape[0]
    out[0] = 0.0
    if held < 2 * limit:
        limit = held // 2
    # covariance of lagged copies over the samples where all lags exist
    for j in range(limit):
        total = 0.0
        for k in range(limit - 1, held):
            total += ring[(start + k) % size] * ring[(start + k - j) % size]
        work[0, j] = total
    for i in range(1, limit):
        for j in range(i, limit):
            work[i, j] = (
                work[i - 1, j - 1]
                + ring[(start + limit - 1 - i) % size] * ring[(start + limit - 1 - j) % size]
                - ring[(start + held - i) % size] * ring[(start + held - j) % size]
            )
    power = work[0, 0] if limit > 0 else 0.0
    if not 1e-250 < power < 1e250:
        return
    for i in range(limit):
        pivot = work[i, i]
        for k in range(i):
            pivot -= work[k, i] * work[k, i]
        if not pivot > PIVOT * power:
            return
        out[0] = i + 1.0
        root = np.sqrt(pivot)
        work[i, i] = root
        for j in range(i + 1, limit):
            total = work[i, j]
            for k in range(i):
                total -= work[k, i] * work[k, j]
            work[i, j] = total / root


@kernel('void(f8[:], f8[:], f8, f8[:])', '(w),(s),()->()')
def _whiteness(ring, state, lags, out):  # type: ignore[no-untyped-def]  # noqa: ANN001, ANN202
    size = ring.shape[0]
    held = int(state[0])
    start = int(state[1]) - held
    out[0] = np.nan
    if held < 3 * lags:
        return
    mean = 0.0
    for k in range(held):
        mean += ring[(start + k) % size]
    mean /= held
    power = 0.0
    for k in range(held):
        e = ring[(start + k) % size] - mean
        power += e * e
    if not 1e-250 < power < 1e250:
        return
    q = 0.0
    for j in range(1, int(lags) + 1):
        total = 0.0
        for k in range(j, held):
            total += (ring[(start + k) % size] - mean) * (ring[(start + k - j) % size] - mean)
        r = total / power
        q += r * r / (held - j)
    out[0] = held * (held + 2.0) * q / lags


class RecentSignal:
    """The last `window` values of a signal, per item of `shape`.

    Args:
        window: samples.
        shape: leading axes.
    """

    def __init__(self, window: int, shape: tuple[int, ...] = ()) -> None:
        self._ring = np.zeros((*shape, window))
        self._state = np.zeros((*shape, 2))
        self._shape = shape

    def push(self, value: Array, active: Mask | bool = True) -> None:
        """Take a value (shape) where `active` (shape) holds; finite there."""
        _push(value, active, self._ring, self._state)

    def clear(self, mask: Mask | bool = True) -> None:
        """Empty the window where `mask` (shape) holds."""
        self._state[...] = np.where(np.asarray(mask)[..., None], 0.0, self._state)

    def excitation_order(self, limit: int) -> Array:
        """Order of persistent excitation, (shape); no more than `limit`, nor than half the samples held."""
        work = np.zeros((*self._shape, limit, limit))
        return np.asarray(_order(self._ring, self._state, work))

    def whiteness(self, lags: int) -> Array:
        """Ljung-Box statistic over `lags`, divided by it, (shape); NaN with fewer than 3 lags samples or no power."""
        return np.asarray(_whiteness(self._ring, self._state, float(lags)))
