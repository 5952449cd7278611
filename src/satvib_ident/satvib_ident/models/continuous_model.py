# SPDX-FileCopyrightText: 2026 The satvib authors
# SPDX-License-Identifier: Apache-2.0
"""Models in continuous time, and the two ways there from an IIR model.

Tustin: z = (1 + s T/2) / (1 - s T/2). Zero-order hold: poles s_i = ln(z_i) / T, and the numerator whose
step-invariant discretization is the given model. The paper's "d2c" print of G(z), s = -104 +- 80.3i, is Tustin at
100 Hz; zero-order hold gives -92.3 +- 95.4i.
"""

from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike
from satvib_common.arrays import Array, Complex
from satvib_common.errors import SatvibError

from satvib_ident.models.polynomials import roots


@dataclass(frozen=True, eq=False)
class ContinuousModel:
    """G(s) = exp(-s dead_time) numerator / denominator, or a batch of them.

    Attributes:
        numerator: (..., m) highest power first.
        denominator: (..., n + 1) highest power first, leading coefficient 1.
        dead_time: s.
    """

    numerator: Array
    denominator: Array
    dead_time: float

    def poles(self) -> Complex:
        """Poles in s, rad/s, (..., n)."""
        return roots(self.denominator)

    def zeros(self) -> Complex:
        """Zeros in s, rad/s, (..., m - 1); inf where the leading coefficient is 0."""
        return roots(self.numerator)

    def frequency_response(self, frequency: ArrayLike) -> Complex:
        """G(j 2 pi f), dead time included; `frequency` in Hz, scalar or (f,)."""
        f = np.asarray(frequency, dtype=float)
        s = 2j * np.pi * np.atleast_1d(f)
        top, bottom = np.zeros((2, *self.numerator.shape[:-1], s.size), dtype=complex)
        for i in range(self.numerator.shape[-1]):
            top = top * s + self.numerator[..., i, None]
        for i in range(self.denominator.shape[-1]):
            bottom = bottom * s + self.denominator[..., i, None]
        response = top / bottom * np.exp(-s * self.dead_time)
        return response[..., 0] if f.ndim == 0 else response

    def _dominant(self) -> tuple[Complex, Complex]:
        """The slowest pole and its partner: its conjugate, or the next slowest real pole, or itself."""
        poles = self.poles()
        if poles.shape[-1] == 0:
            raise SatvibError('model: without poles there is no natural frequency')
        order = np.argsort(-np.nan_to_num(poles.real, nan=-np.inf), axis=-1, kind='stable')
        poles = np.take_along_axis(poles, order, axis=-1)
        first = poles[..., 0]
        second = poles[..., 1] if poles.shape[-1] > 1 else first
        return first, np.where(first.imag != 0.0, np.conj(first), second.real)

    def natural_frequency(self) -> Array:
        """Sqrt of the product of the dominant pair, rad/s, (...).

        The pair is the pole with the largest real part and its conjugate; for a real one, the next real one.
        """
        first, second = self._dominant()
        return np.asarray(np.sqrt(np.abs(first * second)))

    def damping(self) -> Array:
        """Damping ratio of the dominant pair, (...); above 1 for two real poles."""
        first, second = self._dominant()
        return np.asarray(-(first + second).real / (2.0 * self.natural_frequency()))


def _product(count_minus: int, count_plus: int, scale: float) -> Array:
    """(1 - x)^p (1 + x)^q with x = scale s, highest power first."""
    out = np.ones(1)
    for _ in range(count_minus):
        out = np.convolve(out, [-scale, 1.0])
    for _ in range(count_plus):
        out = np.convolve(out, [scale, 1.0])
    return out


def from_tustin(a: Array, b: Array, dead_time: float, dt: float) -> ContinuousModel:
    """Bilinear equivalent of b(z^-1)/a(z^-1); a (..., n) without its leading 1, b (..., m)."""
    full = np.concatenate([np.ones((*a.shape[:-1], 1)), a], axis=-1)
    count = max(full.shape[-1], b.shape[-1]) - 1
    basis = np.array([_product(i, count - i, dt / 2.0) for i in range(count + 1)])
    top = b @ basis[: b.shape[-1]]
    bottom = full @ basis[: full.shape[-1]]
    lead = bottom[..., :1]
    if np.any(np.abs(lead) < 1e-14 * np.abs(bottom).max(axis=-1, keepdims=True)):
        raise SatvibError('model: a pole at z = -1 has no bilinear equivalent')
    return ContinuousModel(top / lead, bottom / lead, dead_time)


def _zoh_item(a: Array, b: Array, dt: float) -> tuple[Array, Array]:
    n = a.size
    if b.size > n + 1:
        raise SatvibError(
            f'model: {b.size} input coefficients with {n} poles have no zero-order-hold equivalent; '
            'use tustin'
        )
    full = np.zeros(n + 1)
    full[: b.size] = b
    if n == 0:
        return full, np.ones(1)
    poles = np.roots(np.concatenate([[1.0], a]))
    if np.any((poles.imag == 0.0) & (poles.real <= 0.0)) or not np.isfinite(poles).all():
        raise SatvibError(
            'model: a pole on the negative real axis or at 0 has no zero-order-hold equivalent; '
            'use tustin'
        )
    # controllable form, input matrix joined: [Phi Gamma; 0 1] = expm([A B; 0 0] T)
    phi = np.zeros((n, n))
    phi[0] = -a
    phi[1:, :-1] = np.eye(n - 1)
    step = np.zeros((n + 1, n + 1))
    step[:n, :n] = phi
    step[0, n] = 1.0
    step[n, n] = 1.0
    from scipy.linalg import logm, solve  # slow to import, and no node asks for it

    log = np.real(logm(step)) / dt
    state, drive = log[:n, :n], log[:n, n]
    row, through = full[1:] - full[0] * a, full[0]
    bottom = np.real(np.poly(state))
    # numerator by evaluation at n + 1 points on a circle of the size of the poles
    radius = max(float(np.max(np.abs(np.linalg.eigvals(state)))), 1.0 / dt)
    points = 2.0 * radius * np.exp(2j * np.pi * np.arange(n + 1) / (n + 1))
    values = [
        (row @ solve(p * np.eye(n) - state, drive) + through) * np.polyval(bottom, p)
        for p in points
    ]
    scaled = np.fft.fft(values) / (n + 1)
    top = np.real(scaled / (2.0 * radius) ** np.arange(n + 1))[::-1]
    return top, bottom


def from_zero_order_hold(a: Array, b: Array, dead_time: float, dt: float) -> ContinuousModel:
    """Step-invariant equivalent of b(z^-1)/a(z^-1), item by item.

    Raises:
        SatvibError: a pole at 0 or on the negative real axis, or more than n + 1 input coefficients.
    """
    n = a.shape[-1]
    top = np.empty((*a.shape[:-1], n + 1))
    bottom = np.empty((*a.shape[:-1], n + 1))
    for index in np.ndindex(a.shape[:-1]):
        top[index], bottom[index] = _zoh_item(a[index], b[index], dt)
    return ContinuousModel(top, bottom, dead_time)
