# SPDX-FileCopyrightText: 2026 The satvib authors
# SPDX-License-Identifier: Apache-2.0
"""The paper's model of a strut, its poles and its responses.

Eqs. (28)-(30) with an explicit input delay d in samples:

    y(k) + a1 y(k-1) + ... + an y(k-n) = b1 u(k-d) + b2 u(k-d-1) + ... + bm u(k-d-m+1)
    G(z) = z^-d (b1 + b2 z^-1 + ... + bm z^(1-m)) / (1 + a1 z^-1 + ... + an z^-n)

y is an acceleration in m/s^2 and u a voltage in V. The paper's own print has d = 0; in the graph d = 1, because
y(k+1) is the first sample that sees u(k).
"""

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import ArrayLike
from satvib_common.arrays import Array, Complex, Mask
from satvib_common.errors import SatvibError, printable
from satvib_common.kernels.compile import kernel

from satvib_ident.models.continuous_model import ContinuousModel, from_tustin, from_zero_order_hold
from satvib_ident.models.polynomials import pole_modulus, roots


@kernel('void(f8[:], f8[:], f8[:], f8[:], i8, f8[:], f8[:])', '(n),(m),(t),(t),(),(s)->(t)')
def _run(a, b, u, y, one_step, start, out):
    """Run the difference equation over a record; `u` is already delayed.

    The first outputs are those of `start`; `one_step` uses the measured `y` instead of the model's own past.
    """
    n, m = a.shape[0], b.shape[0]
    for k in range(u.shape[0]):
        if k < start.shape[0]:
            out[k] = start[k]
            continue
        total = 0.0
        for i in range(m):
            if k - i >= 0:
                total += b[i] * u[k - i]
        for i in range(n):
            if k - 1 - i >= 0:
                total -= a[i] * (y[k - 1 - i] if one_step else out[k - 1 - i])
        out[k] = total


@dataclass(frozen=True, eq=False)
class IirModel:
    """A linear model, or a batch of them with one order, one delay and one sample period.

    Attributes:
        a: (..., n) coefficients of the past outputs, without the leading 1; n may be 0.
        b: (..., m) coefficients of the inputs, m/s^2/V.
        delay: samples between an input and the first output that it can reach.
        dt: s, sample period.
    """

    a: Array
    b: Array
    delay: int
    dt: float

    def __init__(self, a: ArrayLike, b: ArrayLike, delay: int, dt: float) -> None:
        """Check and broadcast; raises SatvibError naming what is wrong."""
        first, second = np.asarray(a, dtype=float), np.asarray(b, dtype=float)
        if first.ndim < 1 or second.ndim < 1 or second.shape[-1] < 1:
            raise SatvibError('model: a and b are lists of numbers, b with at least one')
        if delay < 0 or int(delay) != delay:
            raise SatvibError(f'model: delay: {delay} is not a whole number of samples')
        if not (np.isfinite(dt) and dt > 0.0):
            raise SatvibError(f'model: dt: {dt} is not a positive time in s')
        lead = np.broadcast_shapes(first.shape[:-1], second.shape[:-1])
        object.__setattr__(self, 'a', np.broadcast_to(first, (*lead, first.shape[-1])).copy())
        object.__setattr__(self, 'b', np.broadcast_to(second, (*lead, second.shape[-1])).copy())
        object.__setattr__(self, 'delay', int(delay))
        object.__setattr__(self, 'dt', float(dt))

    @property
    def shape(self) -> tuple[int, ...]:
        """Leading axes."""
        return self.a.shape[:-1]

    @property
    def order(self) -> int:
        """Number of poles, n."""
        return self.a.shape[-1]

    @property
    def theta(self) -> Array:
        """The coefficients a and b joined, (..., n + m), in the order of Eq. (31)."""
        return np.concatenate([self.a, self.b], axis=-1)

    @property
    def denominator(self) -> Array:
        """1, a1, ... an in z^-1, (..., n + 1)."""
        return np.concatenate([np.ones((*self.shape, 1)), self.a], axis=-1)

    def __getitem__(self, index: Any) -> 'IirModel':
        """Take items of the batch."""
        if not self.shape:
            raise SatvibError('model: a single model has no items to take')
        index = index if isinstance(index, tuple) else (index,)
        return IirModel(
            self.a[(*index, ..., slice(None))],
            self.b[(*index, ..., slice(None))],
            self.delay,
            self.dt,
        )

    # ---------------------------------------------------------------- poles, zeros, responses
    def poles(self) -> Complex:
        """Poles in z, (..., n); NaN for an item with a coefficient that is not finite."""
        return roots(self.denominator)

    def zeros(self) -> Complex:
        """Zeros in z, (..., m - 1), without the delay's; a zero at infinity (b1 = 0) is inf."""
        return roots(self.b)

    def pole_modulus(self) -> Array:
        """Largest modulus of the poles, (...); 0 without poles."""
        return np.asarray(pole_modulus(self.a))

    def is_stable(self, radius: float = 1.0) -> Mask:
        """Whether all poles lie inside the circle of `radius`, (...)."""
        return np.asarray(self.pole_modulus() < radius)

    def frequency_response(self, frequency: ArrayLike) -> Complex:
        """G(exp(j 2 pi f dt)), delay included.

        Args:
            frequency: Hz, scalar or (f,).

        Returns:
            (...) or (..., f), m/s^2/V.
        """
        f = np.asarray(frequency, dtype=float)
        z1 = np.exp(-2j * np.pi * np.atleast_1d(f) * self.dt)
        top, bottom = np.zeros((2, *self.shape, z1.size), dtype=complex)
        for i in reversed(range(self.b.shape[-1])):
            top = top * z1 + self.b[..., i, None]
        for i in reversed(range(self.order)):
            bottom = (bottom + self.a[..., i, None]) * z1
        response = z1**self.delay * top / (1.0 + bottom)
        return response[..., 0] if f.ndim == 0 else response

    def steady_gain(self) -> Array:
        """G(1), (...)."""
        return np.asarray(self.b.sum(axis=-1) / self.denominator.sum(axis=-1))

    def instantaneous_gain(self) -> Array:
        """First non-zero coefficient of b, (...): the response `delay` samples after a step.

        It is the high-frequency gain of the plant: a coil's force is acceleration at once.
        """
        nonzero = self.b != 0.0
        index = np.argmax(nonzero, axis=-1)
        return np.take_along_axis(self.b, index[..., None], axis=-1)[..., 0]

    def polarity(self, frequency: float | None = None) -> Array:
        """Sign of the plant, (...): +1, -1, or 0 when the response is nothing.

        Args:
            frequency: Hz; the sign of the real part of the response without its delay there. None: the sign of
                `instantaneous_gain`.
        """
        if frequency is None:
            return np.sign(self.instantaneous_gain())
        undelayed = IirModel(self.a, self.b, 0, self.dt)
        return np.sign(undelayed.frequency_response(frequency).real)

    # ---------------------------------------------------------------- continuous time
    def to_continuous(self, method: str = 'tustin') -> ContinuousModel:
        """Convert to G(s); the delay is kept aside as a dead time of `delay * dt`.

        Args:
            method: 'tustin' (what the paper's d2c did, whatever it says) or 'zoh'.

        Raises:
            SatvibError: an unknown method, or a model that has no such equivalent.
        """
        if method == 'tustin':
            return from_tustin(self.a, self.b, self.delay * self.dt, self.dt)
        if method == 'zoh':
            return from_zero_order_hold(self.a, self.b, self.delay * self.dt, self.dt)
        raise SatvibError(f'method: {method!r} is not one of tustin, zoh')

    def natural_frequency(self, method: str = 'tustin') -> Array:
        """Natural frequency of the dominant poles, rad/s, (...)."""
        return self.to_continuous(method).natural_frequency()

    def damping(self, method: str = 'tustin') -> Array:
        """Damping ratio of the dominant poles, (...)."""
        return self.to_continuous(method).damping()

    # ---------------------------------------------------------------- records
    def _delayed(self, u: Array) -> Array:
        late = np.zeros_like(u)
        late[..., self.delay :] = u[..., : u.shape[-1] - self.delay]
        return late

    def simulate(self, u: ArrayLike, start: ArrayLike = ()) -> Array:
        """Run free: the output for an input from rest.

        Args:
            u: (..., t) V.
            start: (..., s) m/s^2; outputs that are taken as given for the first s samples.

        Returns:
            (..., t) m/s^2.
        """
        u = np.asarray(u, dtype=float)
        first = np.asarray(start, dtype=float)
        return np.asarray(_run(self.a, self.b, self._delayed(u), u, 0, first))

    def predict(self, y: ArrayLike, u: ArrayLike) -> Array:
        """One-step predictions of a record, Eq. (33): (..., t) from y (..., t) and u (..., t).

        What lies before the record counts as zero.
        """
        y, u = np.asarray(y, dtype=float), np.asarray(u, dtype=float)
        return np.asarray(_run(self.a, self.b, self._delayed(u), y, 1, np.zeros(0)))

    # ---------------------------------------------------------------- plain data
    def to_mapping(self) -> dict[str, Any]:
        """Give plain data, as YAML holds it; `from_mapping` takes it back to the last bit."""
        return {
            'delay': self.delay,
            'sample_period': self.dt,
            'a': self.a.tolist(),
            'b': self.b.tolist(),
        }

    @classmethod
    def from_mapping(cls, mapping: Mapping[str, Any], where: str = 'model') -> 'IirModel':
        """Build from plain data with the keys a, b, delay, sample_period (s); others are refused.

        Raises:
            SatvibError: an unknown or missing key, or a value that is no model.
        """
        known = ('a', 'b', 'delay', 'sample_period')
        if not isinstance(mapping, Mapping):
            raise SatvibError(f'{where}: a mapping with {", ".join(known)} is expected')
        for key in mapping:
            if key not in known:
                shown = printable(str(key), 40)
                raise SatvibError(f'{where}: {shown}: no such key (known: {", ".join(known)})')
        for key in known:
            if key not in mapping:
                raise SatvibError(f'{where}: {key}: missing')
        try:
            model = cls(mapping['a'], mapping['b'], mapping['delay'], mapping['sample_period'])
        except (TypeError, ValueError, OverflowError) as error:
            raise SatvibError(f'{where}: not numbers: {error}') from None
        except SatvibError as error:
            raise SatvibError(f'{where}: {error}') from None
        if not (np.isfinite(model.a).all() and np.isfinite(model.b).all()):
            raise SatvibError(f'{where}: a or b holds a number that is not finite')
        return model
