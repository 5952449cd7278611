# SPDX-FileCopyrightText: 2026 The satvib authors
# SPDX-License-Identifier: Apache-2.0
"""What a feedforward filter is a weighted sum of, and the same seen through the secondary path.

The reference x is the lower plate's acceleration without the strut's own reaction (see `reaction`). The filter is
u(k) = w^T phi(k) with the regressor

    phi(k) = [x(k) ... x(k-L+1),  w_0 v(k), w_0^2 s(k),  u(k-1) ... u(k-P)],

L taps, velocity v and displacement s of the lower plate, P own past voltages (filtered-u only). v and s have a physical
reason: a strut that passes no force needs u = -(R / k_F) (C v + K s). That is a double integrator, and an FIR filter
would need seconds of taps to resemble it. They come from drift-free integrators,

    v / x = s / (s + w_m)^2,    s / x = s / (s + w_m)^3    (s: Laplace's on the right),

by Tustin's rule. The factor w_0 = 2 pi 10 rad/s makes all weights of one size.

Filtered-x: phi_f = G_hat phi. G_hat and the filters above are linear, so phi_f is made like phi, from x_f = G_hat x and
u_f = G_hat u. The same kernel runs over a whole history when G_hat changes; phi_f and its filters are then what they
would be if the new model had always been there. With poles there is also phi_g = phi_f / (1 - C), see `filtered_u`.
"""

import math
from enum import IntEnum
from typing import NamedTuple, Self

import numpy as np
from satvib_common.arrays import Array
from satvib_common.kernels.compile import kernel
from satvib_common.kernels.deferred import njit
from satvib_common.kernels.direct_form import filter_sample

SCALE = 2.0 * math.pi * 10.0


class Contents(NamedTuple):
    """What a regressor holds: number of taps, whether velocity and displacement, number of poles (at most the taps)."""

    taps: int
    motion: int
    poles: int

    @property
    def size(self) -> int:
        """Number of weights p."""
        return self.taps + 2 * self.motion + self.poles


class MotionFilter(NamedTuple):
    """Sections of the motion filters.

    h (1 - z^-1) / (1 - p z^-1) is s / (s + w), and g (1 + z^-1) / (1 - p z^-1) is SCALE / (s + w).
    """

    h: float
    g: float
    p: float


class _Row(IntEnum):
    """Rows of `rows` and of `motion`."""

    PLAIN = 0  # phi
    FILTERED = 1  # phi_f
    GRADIENT = 2  # phi_g, where there are poles


class _Through(IntEnum):
    """What goes through G_hat: rows of `filters`."""

    APPLIED = 0
    REFERENCE = 1
    OWN = 2


class _Before(IntEnum):
    """What is kept of the sample before."""

    REFERENCE = 0
    OWN_EFFECT = 1


class RegressorState(NamedTuple):
    """What is remembered from sample to sample; the kernel changes the arrays in place.

    Attributes:
        voltages: (*shape, r) V, past of the applied voltage, newest first.
        before: (*shape, 2) m/s^2, reference and G_hat own of the sample before.
        filters: (*shape, 3, m) states of G_hat on the applied voltage, the reference and the own voltage.
        motion: (*shape, l, 3) states of the motion filters of x, x_f and, with poles, x_g; l is 2 or 3.
        rows: (*shape, l, p) phi, phi_f and, with poles, phi_g.
    """

    voltages: Array
    before: Array
    filters: Array
    motion: Array
    rows: Array

    @classmethod
    def zeros(cls, contents: Contents, reaction: int, path: int, shape: tuple[int, ...]) -> Self:
        """At rest; `reaction` and `path` are the lengths r and m of the reaction and of G_hat."""
        rows = len(_Row) if contents.poles else len(_Row) - 1
        return cls(
            voltages=np.zeros((*shape, reaction)),
            before=np.zeros((*shape, len(_Before))),
            filters=np.zeros((*shape, len(_Through), path)),
            motion=np.zeros((*shape, rows, 3)),
            rows=np.zeros((*shape, rows, contents.size)),
        )

    @property
    def regressor(self) -> Array:
        """Phi, (*shape, p)."""
        return self.rows[..., _Row.PLAIN, :]

    @property
    def filtered(self) -> Array:
        """Phi_f = G_hat phi, (*shape, p)."""
        return self.rows[..., _Row.FILTERED, :]

    @property
    def gradient(self) -> Array:
        """Change of the residual per weight, (*shape, p): phi_f, with poles phi_f / (1 - C)."""
        return self.rows[..., -1, :]

    def take_plain(self, other: Self) -> None:
        """Copy from `other` what is not seen through G_hat, so what u is made of."""
        self.voltages[...] = other.voltages
        self.before[..., _Before.REFERENCE] = other.before[..., _Before.REFERENCE]
        self.motion[..., _Row.PLAIN, :] = other.motion[..., _Row.PLAIN, :]
        self.rows[..., _Row.PLAIN, :] = other.rows[..., _Row.PLAIN, :]


def motion_coefficients(corner: float, dt: float) -> Array:
    """`MotionFilter` as an array (3,), by Tustin's rule; corner in Hz, dt in s."""
    w, c = 2.0 * math.pi * corner, 2.0 / dt
    return np.array(MotionFilter(h=c / (c + w), g=SCALE / (c + w), p=(c - w) / (c + w)))


@njit
def _motion(section, state, x):
    """One sample of both filters: scaled velocity and displacement."""
    h, g, p = section
    high = h * x + state[0]
    state[0] = p * high - h * x
    velocity = g * high + state[1]
    state[1] = g * high + p * velocity
    shift = g * velocity + state[2]
    state[2] = g * velocity + p * shift
    return velocity, shift


@njit
def _push(row, contents, x, motion, u):
    """Shift a regressor by one sample; `motion` is the pair of velocity and displacement."""
    for i in range(contents.taps - 1, 0, -1):
        row[i] = row[i - 1]
    row[0] = x
    first = contents.taps
    if contents.motion:
        row[first], row[first + 1] = motion
        first += 2
    if contents.poles > 0:
        for i in range(first + contents.poles - 1, first, -1):
            row[i] = row[i - 1]
        row[first] = u


@njit
def _push_gradient(xf, uf, weights, section, contents, state):
    """Shift phi_g, what is filtered through 1 / (1 - C); its own past stands in its row."""
    row = state.rows[_Row.GRADIENT]
    first = row.shape[0] - contents.poles
    for i in range(contents.poles):
        xf += weights[first + i] * row[i]
        uf += weights[first + i] * row[first + i]
    _push(row, contents, xf, _motion(section, state.motion[_Row.GRADIENT], xf), uf)


@njit
def _without_reaction(lower, applied, reaction, voltages):
    """The reference: what the lower sensor measures without the response to the last voltages."""
    for i in range(voltages.shape[0] - 1, 0, -1):
        voltages[i] = voltages[i - 1]
    voltages[0] = applied
    x = lower
    for i in range(reaction.shape[0]):
        x -= reaction[i] * voltages[i]
    return x


class Path(NamedTuple):
    """What the regressor is filtered with: G_hat z as num / den (m), the reaction (r) and the motion filters."""

    num: Array
    den: Array
    reaction: Array
    section: MotionFilter


@njit
def advance(lower, applied, own, path, contents, weights, state):
    """Advance one item by a sample; see `run_regressor`. Gives the reference and the effect."""
    num, den, reaction, section = path
    before, filters, motion, rows = state.before, state.filters, state.motion, state.rows
    x = _without_reaction(lower, applied, reaction, state.voltages)
    effect = filter_sample(num, den, filters[_Through.APPLIED], applied)
    xf = filter_sample(num, den, filters[_Through.REFERENCE], before[_Before.REFERENCE])
    # the regressor of u is one sample old, so its filtered twin is the effect of the sample before
    uf = before[_Before.OWN_EFFECT]
    if rows.shape[0] > _Row.GRADIENT:
        _push_gradient(xf, uf, weights, section, contents, state)
    _push(rows[_Row.PLAIN], contents, x, _motion(section, motion[_Row.PLAIN], x), own)
    _push(rows[_Row.FILTERED], contents, xf, _motion(section, motion[_Row.FILTERED], xf), uf)
    before[_Before.REFERENCE] = x
    before[_Before.OWN_EFFECT] = filter_sample(num, den, filters[_Through.OWN], own)
    return x, effect


@njit
def plain_of(rows):
    """Phi (p) among the rows of one item."""
    return rows[_Row.PLAIN]


@njit
def filtered_of(rows):
    """Phi_f (p) among the rows of one item."""
    return rows[_Row.FILTERED]


@kernel(
    'void(f8[:],f8[:],f8[:],f8[:],f8[:],f8[:],f8[:],i8[:],f8[:],f8[:],f8[:],f8[:,:],f8[:,:],f8[:,:],f8[:],f8[:])',
    '(t),(t),(t),(r),(m),(m),(c),(z),(p),(r),(q),(g,m),(l,d),(l,p)->(t),(t)',
    writable=('voltages', 'before', 'filters', 'motion', 'rows'),
)
def run_regressor(
    lower, applied, own, reaction, num, den, coefficients, sizes, weights,
    voltages, before, filters, motion, rows, reference, effect,
):  # fmt: skip
    """Advance by t samples.

    Args:
        lower: (t) m/s^2 as measured, finite.
        applied: (t) V, the voltage of the sample before, as the guard let it out.
        own: (t) V, what the filter itself gave on the sample before.
        reaction: (r) m/s^2/V, response of the lower sensor to `applied`.
        num, den: (m) G_hat z in z^-1: its delay is counted from the sample that a voltage was computed from, and the
            voltages here are one sample old.
        coefficients: (3) `MotionFilter`.
        sizes: (3) `Contents`.
        weights: (p) of the filter, of which the last are its poles' c.
        voltages, before, filters, motion, rows: `RegressorState`, changed.
        reference: (t) out, x, m/s^2.
        effect: (t) out, G_hat applied, m/s^2: what the voltage does to the upper sensor.
    """
    path = Path(num, den, reaction, MotionFilter(coefficients[0], coefficients[1], coefficients[2]))
    contents = Contents(sizes[0], sizes[1], sizes[2])
    state = RegressorState(voltages, before, filters, motion, rows)
    for k in range(lower.shape[0]):
        reference[k], effect[k] = advance(
            lower[k], applied[k], own[k], path, contents, weights, state
        )


def response_table(contents: Contents, corner: float, dt: float, f: Array) -> Array:
    """Responses of the elements of the regressor to the reference; those of the poles to the voltage.

    Args:
        contents: of the regressor.
        corner: Hz, of the motion filters.
        dt: s.
        f: (f,) shares of the sample rate.

    Returns:
        (f, p, 2) real and imaginary parts.
    """
    z = np.exp(-2j * np.pi * f)
    h, g, p = motion_coefficients(corner, dt)
    high, low = h * (1.0 - z) / (1.0 - p * z), g * (1.0 + z) / (1.0 - p * z)
    columns = [z**i for i in range(contents.taps)]
    if contents.motion:
        columns += [high * low, high * low * low]
    columns += [z**i for i in range(1, contents.poles + 1)]
    table = np.stack(columns, axis=-1)
    return np.stack([table.real, table.imag], axis=-1)
