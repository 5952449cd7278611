# SPDX-FileCopyrightText: 2026 The satvib authors
# SPDX-License-Identifier: Apache-2.0
"""The regression of a transfer function in s, and the IIR model that it stands for.

    y (s^n + alpha_1 s^(n-1) + ... + alpha_n) = (beta_1 s^(m-1) + ... + beta_m) u,   m <= n + 1
    D^n y_f = -alpha_1 D^(n-1) y_f - ... - alpha_n y_f + beta_1 D^(m-1) u_f + ... + beta_m u_f

with both signals through the same state-variable filter; the paper's first-order example, Eqs. (1)-(3), is n = m =
1. The voltage stands still between samples, so it is filtered exactly; the measurement is taken to run straight,
which costs about (w dt)^2 / 12 of relative error at w, and more where y jumps: sample at 20 times the natural
frequency at least.
"""

import math

import numpy as np
from satvib_common.arrays import Array, Mask
from satvib_common.errors import SatvibError

from satvib_ident.estimators.continuous.discretize import discretize, discretized_covariance
from satvib_ident.estimators.continuous.filter import StateVariableFilter


class ContinuousRegressor:
    """Filtered derivatives of both signals, per item of `shape`.

    Args:
        poles: n, at least 1.
        coefficients: m, 1 to n + 1.
        corner: Hz, of the state-variable filters.
        dt: s, sample period.
        shape: leading axes.
        unit: s, the unit of time of the parameters: alpha_i is per unit^i. 1 / (2 pi corner) makes all of one size,
        which
            the gradient and the normalized algorithm need.
    """

    def __init__(
        self,
        poles: int,
        coefficients: int,
        corner: float,
        dt: float,
        shape: tuple[int, ...] = (),
        unit: float = 1.0,
    ) -> None:
        if poles < 1 or not 1 <= coefficients <= poles + 1:
            raise SatvibError(
                f'orders: {poles} poles and {coefficients} coefficients; in continuous time at '
                'least 1 pole and 1 to poles + 1 coefficients are needed'
            )
        self.poles, self.coefficients, self.shape = poles, coefficients, shape
        self.period = dt / unit
        self._scale = unit ** np.arange(poles + 1)
        self._y = StateVariableFilter(poles, corner, dt, held=False, shape=shape)
        self._u = StateVariableFilter(poles, corner, dt, held=True, shape=shape)
        # from a break on, until what the filters did not see has died out to 3e-4
        self._settle = math.ceil((8.0 + 2.0 * poles) / (2.0 * math.pi * corner * dt))
        self._age = np.zeros(shape)

    @property
    def count(self) -> int:
        """Number of parameters, n + m."""
        return self.poles + self.coefficients

    def step(self, y: Array, voltage: Array, bias: Array | float) -> tuple[Array, Array, Mask]:
        """Take y(k) (shape, m/s^2) and the voltage held until then (shape, V), NaN where not known.

        Returns:
            w (*shape, p), the target D^n y_f (shape), and whether both may be used (shape).
        """
        known = np.isfinite(y) & np.isfinite(voltage)
        output = self._scale * self._y.step(np.where(known, y - bias, 0.0))
        drive = self._scale * self._u.step(np.where(known, voltage, 0.0))
        if not known.all():
            self.clear(~known)
        self._age = np.where(known, self._age + 1.0, 0.0)
        n, m = self.poles, self.coefficients
        w = np.concatenate(
            [-output[..., n - 1 :: -1][..., :n], drive[..., m - 1 :: -1][..., :m]], axis=-1
        )
        return w, output[..., n], np.asarray(known & (self._age > self._settle))

    def clear(self, mask: Mask | bool = True) -> None:
        """Start from rest where `mask` (shape) holds."""
        self._y.clear(mask)
        self._u.clear(mask)
        self._age = np.where(mask, 0.0, self._age)

    def model(self, theta: Array, covariance: Array) -> tuple[Array, Array]:
        """The IIR coefficients (*shape, n + n + 1) that theta (*shape, p) stands for, and their covariance."""
        return (
            discretize(theta, self.poles, self.period),
            discretized_covariance(theta, covariance, self.poles, self.period),
        )
