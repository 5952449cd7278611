# SPDX-FileCopyrightText: 2026 The satvib authors
# SPDX-License-Identifier: Apache-2.0
"""The dominant mode of an identified model, the polarity of its coil, and the gain that gives a wanted damping.

The mode. For an isolator G ~ s^2 / (s^2 + 2 zeta w s + w^2) the loop L = C G with C ~ 1/s has its peak at w for any
damping. The poles alone do not show the mode: an identified model of higher order has poles that zeros cancel, often
nearest to the unit circle, and poles of filters. So the mode is the pole (or pair) whose partial fraction, without the
input delay, is largest at the peak w_p, weighted by 1 / (1 + (2 ln(|s| / w_p))^2) for its distance from the peak. Real
poles count only when no pair makes a twentieth of the peak.

Polarity. The minus signs of the paper's Eqs. (40)-(41) belong to its own wiring. Here the sign comes from the model: it
is the sign of K for which u = -K C y reduces the vibration around and below the mode, that is the sign of

    sum over f in [0.3, 1.1] f_peak of Re L(f) |L(f)|.

(The step response would not do: on a stiff strut with slow sampling it has decayed before the first sample.)

Damping. A second-order mode s^2 + 2 zeta w_0 s + w_0^2 has the response 1 / (2 zeta) at w_0. A loop that makes that
response |1 + K L(w_0)| times smaller has given it the effective damping

    zeta(K) = zeta_0 |1 + K L(w_0)|,

which for an ideal skyhook is the damping of the pole. It is used in the place of the damping of the closed-loop pole,
because filters and delays make poles meet and split, while this stays one number. The gain for a wanted zeta is the
root of a quadratic.
"""

import cmath
import math
from functools import lru_cache
from typing import Any

import numpy as np
from numpy.typing import ArrayLike
from satvib_common.arrays import Array, Complex
from satvib_common.kernels.horner_rule import polynomial
from satvib_ident.models.iir_model import IirModel

from satvib_control.model_analysis.transfer import model_polynomials, value


def _roots(c: Array) -> Complex:
    """Roots in z of a polynomial in z^-1; trailing zeros would be roots at 0, and are left out."""
    last = len(c)
    while last > 1 and c[last - 1] == 0.0:
        last -= 1
    found: Complex = np.roots(c[:last]).astype(complex)
    return found


def _loop(b: Array, a: Array, cb: Array, ca: Array, f: Array) -> Complex:
    """C B/A at frequencies in shares of the sample rate."""
    zi = np.exp(-2j * math.pi * f)
    top = polynomial(b, zi) * polynomial(cb, zi)
    result: Complex = top / (polynomial(a, zi) * polynomial(ca, zi))
    return result


def _peak(b: Array, a: Array, cb: Array, ca: Array) -> float:
    """Frequency at which |C B/A| is largest, as a share of the sample rate."""
    return _peak_of(b.tobytes(), a.tobytes(), cb.tobytes(), ca.tobytes())


# one design needs the same peak and the same pole several times; a campaign makes thousands of designs
@lru_cache(maxsize=16384)
def _peak_of(b: bytes, a: bytes, cb: bytes, ca: bytes) -> float:
    f, zi, top, bottom = _grid(cb, ca)
    loop = polynomial(np.frombuffer(b), zi) * top / (polynomial(np.frombuffer(a), zi) * bottom)
    return float(f[np.argmax(np.abs(loop))])


@lru_cache(maxsize=64)
def _grid(cb: bytes, ca: bytes) -> tuple[Array, Any, Any, Any]:
    """Frequencies in shares of the sample rate, z^-1 there, and numerator and denominator of C."""
    f = np.geomspace(1e-3, 0.4, 300)
    zi = np.exp(-2j * math.pi * f)
    return f, zi, polynomial(np.frombuffer(cb), zi), polynomial(np.frombuffer(ca), zi)


@lru_cache(maxsize=16384)
def _dominant_of(b: bytes, a: bytes, cb: bytes, ca: bytes, delay: int) -> complex:
    tops, poles = (np.frombuffer(b), np.frombuffer(cb)), (np.frombuffer(a), np.frombuffer(ca))
    return _dominant(tops[0], poles[0], tops[1], poles[1], delay)


def _dominant(b: Array, a: Array, cb: Array, ca: Array, delay: int) -> complex:
    """The pole of B/A (upper one of a pair) that makes the peak of C B/A; 0 when there is none."""
    roots = _roots(a)
    roots = roots[(roots.imag >= 0.0) & (np.abs(roots) < 1.0) & (np.abs(roots) > 1e-3)]
    w = 2.0 * math.pi * _peak(b, a, cb, ca)
    turn = cmath.exp(-1j * w)
    height = float(np.abs(_loop(b, a, cb, ca, np.array([w / (2.0 * math.pi)])))[0])
    best, largest = 0.0j, -1.0
    slope = a * np.arange(len(a))  # z^-1 times the derivative of A
    for z in map(complex, roots):
        zi = 1.0 / z
        bottom = value(slope, zi) * value(ca, zi)
        if bottom == 0.0:
            continue
        residue = value(b, zi) * value(cb, zi) * z**delay / bottom
        part = residue / (1.0 - z * turn)
        if z.imag > 0.0:
            part += residue.conjugate() / (1.0 - z.conjugate() * turn)
        distance = 2.0 * math.log(abs(cmath.log(z)) / w)
        score = abs(part) / (1.0 + distance * distance)
        if z.imag == 0.0 or abs(part) < 0.05 * height:
            score *= 1e-6  # chosen only when there is no other
        if score > largest:
            best, largest = z, score
    return best


def dominant_pole(model: IirModel, numerator: ArrayLike, denominator: ArrayLike) -> Complex:
    """Give s = ln z / dt (rad/s) of the dominant pole per item; 0 where there is none.

    Args:
        model: G.
        numerator: (c,), of C in z^-1, lowest power first.
        denominator: (e,), of C.
    """
    b, a = model_polynomials(model)
    cb, ca = np.asarray(numerator, dtype=float), np.asarray(denominator, dtype=float)
    out = np.zeros(a.shape[:-1], dtype=complex)
    for i in np.ndindex(out.shape):
        if np.all(np.isfinite(a[i])) and np.all(np.isfinite(b[i])):
            z = _dominant_of(
                b[i].tobytes(), a[i].tobytes(), cb.tobytes(), ca.tobytes(), model.delay
            )
            out[i] = cmath.log(z) / model.dt if z else 0.0
    return out


def polarity(model: IirModel, numerator: ArrayLike, denominator: ArrayLike) -> Array:
    """Give +1 or -1 per item: the sign of K for which u = -K C y reduces the dominant mode; C as above."""
    b, a = model_polynomials(model)
    cb, ca = np.asarray(numerator, dtype=float), np.asarray(denominator, dtype=float)
    out = np.ones(a.shape[:-1])
    for i in np.ndindex(out.shape):
        if not (np.all(np.isfinite(a[i])) and np.all(np.isfinite(b[i]))):
            continue
        f = np.linspace(0.3, 1.1, 33) * _peak(b[i], a[i], cb, ca)
        near = _loop(b[i], a[i], cb, ca, f)
        out[i] = 1.0 if float((near.real * np.abs(near)).sum()) >= 0.0 else -1.0
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
    poles = dominant_pole(model, numerator, denominator)
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
