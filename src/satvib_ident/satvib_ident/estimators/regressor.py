# SPDX-FileCopyrightText: 2026 The satvib authors
# SPDX-License-Identifier: Apache-2.0
"""The regression vector of the IIR model, Eq. (32), and whether it may be used.

    w(k) = [-y(k-1) ... -y(k-n)  u(k-d) u(k-d-1) ... u(k-d-m+1)]

A value that is not known (NaN), or a sample that never came, leaves a hole that takes n (or m) further samples to
pass through; until then the vector is not full and must not be used.
"""

import numpy as np
from satvib_common.arrays import Array, Mask, every
from satvib_common.errors import SatvibError


class IirRegressor:
    """Histories of both signals, per item of `shape`.

    Args:
        poles: n, at least 1.
        coefficients: m, at least 1.
        delay: d, samples; the caller delays the input, this only remembers by how much.
        shape: leading axes.

    Raises:
        SatvibError: an order of zero or less, or a negative delay.
    """

    def __init__(
        self, poles: int, coefficients: int, delay: int, shape: tuple[int, ...] = ()
    ) -> None:
        if poles < 1 or coefficients < 1:
            raise SatvibError(
                f'orders: {poles} poles and {coefficients} coefficients; each must be at least 1'
            )
        if delay < 0:
            raise SatvibError(f'delay: {delay} is negative')
        self.poles, self.coefficients, self.delay, self.shape = poles, coefficients, delay, shape
        self._y = np.full((*shape, poles), np.nan)
        self._u = np.full((*shape, coefficients), np.nan)

    @property
    def count(self) -> int:
        """Number of parameters, p = n + m."""
        return self.poles + self.coefficients

    def form(self, voltage: Array, bias: Array | float = 0.0) -> tuple[Array, Mask]:
        """Take u(k-d) and give w(k); call `take` with y(k) afterwards.

        Args:
            voltage: (shape) V, NaN where it is not known.
            bias: (shape) m/s^2, taken off the past outputs.

        Returns:
            w (*shape, p) with 0 in place of what is not known, and whether it is full (shape).
        """
        self._u[..., 1:] = self._u[..., :-1]
        self._u[..., 0] = voltage
        w = np.empty((*self.shape, self.count))
        w[..., : self.poles] = np.asarray(bias)[..., None] - self._y
        w[..., self.poles :] = self._u
        known = np.isfinite(w)
        full = np.logical_and.reduce(known, axis=-1)
        return (w, full) if every(full) else (np.where(known, w, 0.0), full)

    def take(self, y: Array) -> None:
        """Take y(k) (shape, m/s^2), NaN where it is not known."""
        self._y[..., 1:] = self._y[..., :-1]
        self._y[..., 0] = y

    def step(self, y: Array, voltage: Array, bias: Array | float) -> tuple[Array, Array, Mask]:
        """Take y(k) (shape, m/s^2 as measured) and u(k-d) (shape, V), NaN where not known.

        Returns:
            w(k) (*shape, p), the target y(k) without its bias (shape), and whether both may be used (shape).
        """
        w, full = self.form(voltage, bias)
        known = np.isfinite(y)
        self.take(np.where(known, y, np.nan))
        return w, np.where(known, y - bias, 0.0), np.asarray(full & known)

    def model(self, theta: Array, covariance: Array) -> tuple[Array, Array]:
        """The IIR coefficients of an estimate (*shape, at least p) and their covariance."""
        p = self.count
        return theta[..., :p].copy(), covariance[..., :p, :p]

    def clear(self, mask: Mask | bool = True) -> None:
        """Empty the histories where `mask` (shape) holds."""
        where = np.asarray(mask)[..., None]
        self._y[...] = np.where(where, np.nan, self._y)
        self._u[...] = np.where(where, np.nan, self._u)
