# SPDX-FileCopyrightText: 2026 The satvib authors
# SPDX-License-Identifier: Apache-2.0
"""The dominant mode of an identified model, the polarity of its coil, and the gain that gives a wanted damping.

Polarity. The paper's Eqs. (40)-(41) carry minus signs that belong to its own wiring. Here the sign comes from the
model: it is the sign of K for which u = -K C y reduces the vibration around and below the mode, that is the sign of

    sum over f in [0.3 f_n, 1.1 f_n] of Re L(f) |L(f)|,    L = C G.

(The step response would not do: a stiff strut sampled slowly has forgotten the kick before the first sample sees it.)

Damping. A second-order mode s^2 + 2 zeta w_0 s + w_0^2 answers at w_0 with 1 / (2 zeta), so a loop that makes that
answer |1 + K L(w_0)| times smaller has given it the effective damping

    zeta(K) = zeta_0 |1 + K L(w_0)|,

which is the pole's own damping for an ideal skyhook. It is used in place of the closed-loop pole's because it stays
one number, and means what people want, where filters and delays make the poles meet and change partners. The gain
that attains a wanted zeta is the root of a quadratic.
"""

import cmath
import math

import numpy as np
from numpy.typing import ArrayLike, NDArray
from satvib_ident.iir_model import IirModel

from satvib_control.polynomial import model_polynomials, value

Array = NDArray[np.float64]


def _roots(c: Array) -> NDArray[np.complex128]:
    """Roots in z of a polynomial in z^-1; trailing zeros are roots at 0, which nobody needs."""
    last = len(c)
    while last > 1 and c[last - 1] == 0.0:
        last -= 1
    found: NDArray[np.complex128] = np.roots(c[:last]).astype(complex)
    return found


def _response(c: Array, zi: NDArray[np.complex128]) -> NDArray[np.complex128]:
    total = np.zeros_like(zi)
    for coefficient in c[::-1]:
        total = total * zi + coefficient
    return total


def _dominant(a: Array) -> complex:
    """The slowest-dying complex pole (upper one of the pair); the slowest real one when there is no pair."""
    roots = _roots(a)
    if len(roots) == 0:
        return 0.0j
    pairs = roots[roots.imag > 1e-9]
    candidates = pairs if len(pairs) else roots
    return complex(candidates[np.argmax(np.abs(candidates))])


def dominant_pole(model: IirModel) -> NDArray[np.complex128]:
    """Give s = ln z / dt (rad/s) of the dominant pole per item; 0 where there is none."""
    a = model_polynomials(model)[1]
    out = np.zeros(a.shape[:-1], dtype=complex)
    for i in np.ndindex(out.shape):
        z = _dominant(a[i]) if np.all(np.isfinite(a[i])) else 0.0j
        out[i] = cmath.log(z) / model.dt if z else 0.0
    return out


def polarity(model: IirModel, numerator: ArrayLike, denominator: ArrayLike) -> Array:
    """Give +1 or -1 per item: the sign of K for which u = -K C y calms the dominant mode.

    Args:
        model: G.
        numerator: (c,), of C in z^-1, lowest power first.
        denominator: (e,), of C.
    """
    b, a = model_polynomials(model)
    cb, ca = np.asarray(numerator, dtype=float), np.asarray(denominator, dtype=float)
    out = np.ones(a.shape[:-1])
    poles = dominant_pole(model)
    for i in np.ndindex(out.shape):
        if not (np.all(np.isfinite(a[i])) and np.all(np.isfinite(b[i]))):
            continue
        w = np.linspace(0.3, 1.1, 33) * abs(poles[i]) * model.dt
        zi = np.exp(-1j * np.minimum(w, math.pi))
        loop = _response(b[i], zi) * _response(cb, zi)
        loop = loop / (_response(a[i], zi) * _response(ca, zi))
        out[i] = 1.0 if float((loop.real * abs(loop)).sum()) >= 0.0 else -1.0
    return out


def damping_gain(
    model: IirModel, numerator: ArrayLike, denominator: ArrayLike, limit: Array, wanted: float
) -> tuple[Array, Array]:
    """Find the gain K between 0 and `limit` that gives the dominant mode an effective damping ratio.

    Args:
        model: G.
        numerator: (c,), of C in z^-1.
        denominator: (e,), of C.
        limit: shape; the largest gain that may be used, with its sign.
        wanted: damping ratio.

    Returns:
        (shape) that gain, or the one of 0 and `limit` with more damping when none attains it; (shape) the damping.
    """
    b, a = model_polynomials(model)
    gain, damping = np.zeros(a.shape[:-1]), np.full(a.shape[:-1], np.nan)
    limit = np.broadcast_to(limit, gain.shape)
    poles = dominant_pole(model)
    for i in np.ndindex(gain.shape):
        s = complex(poles[i])
        if s == 0.0:
            continue
        zi = cmath.exp(-1j * min(abs(s) * model.dt, math.pi))
        loop = value(b[i], zi) * value(numerator, zi) / (value(a[i], zi) * value(denominator, zi))
        gain[i], damping[i] = _attain(-s.real / abs(s), loop, float(limit[i]), wanted)
    return gain, damping


def _attain(own: float, loop: complex, limit: float, wanted: float) -> tuple[float, float]:
    """Solve own |1 + K L| = wanted for K of the sign of `limit`."""
    if own >= wanted or limit == 0.0:
        return 0.0, own
    sign = math.copysign(1.0, limit)
    real, square = sign * loop.real, abs(loop) ** 2
    ratio = math.inf if own <= 0.0 else wanted / own
    if square > 0.0 and math.isfinite(ratio):
        k = (-real + math.sqrt(real * real + square * (ratio * ratio - 1.0))) / square
        if k <= abs(limit):
            return sign * k, wanted
    reached = own * abs(1.0 + limit * loop)
    return (limit, reached) if reached > own else (0.0, own)
