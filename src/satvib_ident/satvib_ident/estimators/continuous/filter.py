# SPDX-FileCopyrightText: 2026 The satvib authors
# SPDX-License-Identifier: Apache-2.0
"""State-variable filter: a signal and its derivatives, low-passed alike, without differentiating.

    x_f = (c / (s + c))^n x,   states x_f, D x_f ... D^(n-1) x_f,   D^n x_f from the filter's own equation

Between the samples the signal is either held (a voltage: the filter is then exact) or runs straight from sample to
sample (a measurement).
"""

import math

import numpy as np
from satvib_common.arrays import Array, Mask
from satvib_common.errors import SatvibError
from satvib_common.kernels.compile import kernel


@kernel(
    'void(f8[:,:], f8[:], f8[:], f8[:], f8, f8, f8[:], f8[:])',
    '(n,n),(n),(n),(d),(),(),(n)->(d)',
    writable=('state',),
)
def _step(phi, first, last, top, before, now, state, out):
    """State <- phi state + first before + last now; out = state and its highest derivative."""
    n = state.shape[0]
    for i in range(n):
        total = first[i] * before + last[i] * now
        for j in range(n):
            total += phi[i, j] * state[j]
        out[i] = total
    highest = top[n] * now
    for i in range(n):
        state[i] = out[i]
        highest -= top[i] * out[i]
    out[n] = highest


class StateVariableFilter:
    """n-th order filter of one signal per item of `shape`.

    Args:
        order: n, at least 1.
        corner: Hz, c / (2 pi).
        dt: s, sample period.
        held: the signal is held over the period that ends with the sample; else it runs straight.
        shape: leading axes.
    """

    def __init__(
        self, order: int, corner: float, dt: float, held: bool, shape: tuple[int, ...] = ()
    ) -> None:
        if order < 1:
            raise SatvibError(f'state-variable filter: order {order}; at least 1 is needed')
        if not 0.0 < corner * dt < 0.5:
            raise SatvibError(
                f'filter_corner: {corner} Hz is not between 0 and half the sample rate, '
                f'{0.5 / dt:g} Hz'
            )
        from scipy.linalg import expm  # slow to import, and most estimators do not filter

        c = 2.0 * math.pi * corner
        poly = np.array([math.comb(order, i) * c ** (order - i) for i in range(order)])
        A = np.eye(order, k=1)
        A[-1] = -poly
        B = np.zeros((order, 1))
        B[-1] = c**order
        # x(t) = x0 + (x1 - x0) t / dt: two integrators in front of the filter give both hold rules at once
        block = np.zeros((order + 2, order + 2))
        block[:order, :order] = A * dt
        block[:order, order : order + 1] = B * dt
        block[order, order + 1] = 1.0
        grown = expm(block)
        step, ramp = grown[:order, order], grown[:order, order + 1]
        self._phi = grown[:order, :order].copy()
        self._first: Array = np.zeros(order) if held else step - ramp
        self._last: Array = step.copy() if held else ramp.copy()
        self._top = np.concatenate([poly, [c**order]])
        self._state = np.zeros((*shape, order))
        self._before = np.zeros(shape)

    def step(self, x: Array) -> Array:
        """Take x(k) (shape) and give [x_f, D x_f ... D^n x_f] (*shape, n + 1)."""
        out = _step(self._phi, self._first, self._last, self._top, self._before, x, self._state)
        self._before = np.asarray(x, dtype=float).copy()
        return np.asarray(out)

    def clear(self, mask: Mask | bool = True) -> None:
        """Start from rest where `mask` (shape) holds."""
        where = np.asarray(mask)
        self._state[...] = np.where(where[..., None], 0.0, self._state)
        self._before = np.where(where, 0.0, self._before)
