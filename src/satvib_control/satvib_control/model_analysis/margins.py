# SPDX-FileCopyrightText: 2026 The satvib authors
# SPDX-License-Identifier: Apache-2.0
"""Margins of a loop u = -K C y on the identified model: modulus, phase, gain and delay.

With L = K C G on the unit circle:

    modulus margin  min |1 + L| = 1 / max |S|
    phase margin    min over |L| = 1 of |arg L - pi|, and the delay margin min over |L| = 1 of that angle / w:
                    how much later the voltage may come until the loop oscillates
    gain margin     the factor on K at which the loop first oscillates

They are found on a grid, and crossings are refined by bisection. Angles of the delay margin are taken clockwise, in
(0, 2 pi].

C and G are evaluated one by one, and their values multiplied. The product of their polynomials would lose digits where
many roots are near z = 1: up to a decibel at 9 Hz and 1 kHz. The coefficients of a model of high order have lost such
digits before. `loop_response` takes the response of G itself, so a rig's exact response keeps all of them.
"""

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike
from satvib_common.arrays import Array, Complex
from satvib_common.kernels.compile import kernel
from satvib_common.kernels.deferred import njit
from satvib_ident.models.iir_model import IirModel

from satvib_control.model_analysis.transfer import model_polynomials, respond, value

LOWEST = 1e-4  # first point of the grid, as a share of the sample rate
POINTS = 4000


@dataclass(frozen=True)
class Margins:
    """Margins of a batch of loops; infinite where there is no such crossing.

    Attributes:
        modulus: shape; least distance of L from -1.
        phase: shape, rad.
        delay: shape, s.
        gain: shape; factor.
    """

    modulus: Array
    phase: Array
    delay: Array
    gain: Array


@njit
def _loop(b, a, cb, ca, gain, omega):
    """L = K C G at e^{j omega}, factor by factor."""
    return gain * respond(cb, ca, omega) * respond(b, a, omega)


@njit
def _height(f, b, a, cb, ca, gain):
    """|L| - 1 at a logarithm of f: its sign changes where |L| = 1."""
    return abs(_loop(b, a, cb, ca, gain, 2.0 * math.pi * math.exp(f))) - 1.0


@njit
def _side(f, b, a, cb, ca, gain):
    """Im L at a logarithm of f: its sign changes where L is real."""
    return _loop(b, a, cb, ca, gain, 2.0 * math.pi * math.exp(f)).imag


@njit
def _crossing(function, low, high, sign, b, a, cb, ca, gain):
    """Angular frequency per sample where a function changes its sign, which is `sign` at `low`, by bisection."""
    for _ in range(50):
        middle = 0.5 * (low + high)
        if function(middle, b, a, cb, ca, gain) * sign > 0.0:
            low = middle
        else:
            high = middle
    return 2.0 * math.pi * math.exp(0.5 * (low + high))


@kernel(
    'void(f8[:],f8[:],f8[:],f8[:],f8,f8[:],f8[:],f8[:],f8[:])', '(p),(r),(s),(t),()->(),(),(),()'
)
def _margins(b, a, cb, ca, k, modulus, phase, delay, gain):
    """Margins of one loop k (cb/ca) (b/a); the delay in samples."""
    start = math.log(LOWEST)
    step = (math.log(0.5) - start) / (POINTS - 1)
    modulus[0] = 1.0
    phase[0] = np.inf
    delay[0] = np.inf
    gain[0] = np.inf
    before = _loop(b, a, cb, ca, k, 2.0 * math.pi * math.exp(start))
    for i in range(1, POINTS):
        low, high = start + step * (i - 1), start + step * i
        here = _loop(b, a, cb, ca, k, 2.0 * math.pi * math.exp(high))
        modulus[0] = min(modulus[0], abs(1.0 + here))
        if (abs(before) - 1.0) * (abs(here) - 1.0) < 0.0:
            w = _crossing(_height, low, high, abs(before) - 1.0, b, a, cb, ca, k)
            crossing = _loop(b, a, cb, ca, k, w)
            angle = math.atan2(crossing.imag, crossing.real)
            phase[0] = min(phase[0], math.pi - abs(angle))
            delay[0] = min(delay[0], (angle + math.pi if angle > -math.pi else 2.0 * math.pi) / w)
        if before.imag * here.imag < 0.0 and here.real < 0.0 and before.real < 0.0:
            w = _crossing(_side, low, high, before.imag, b, a, cb, ca, k)
            crossing = _loop(b, a, cb, ca, k, w)
            if crossing.real > -1.0:
                gain[0] = min(gain[0], -1.0 / crossing.real)
        before = here
    # at half the sample rate L is real
    last = _loop(b, a, cb, ca, k, math.pi).real
    if -1.0 < last < 0.0:
        gain[0] = min(gain[0], -1.0 / last)


def margins(
    model: IirModel, numerator: ArrayLike, denominator: ArrayLike, gain: ArrayLike
) -> Margins:
    """Give the margins of u = -K C y, for a loop that is stable as it is.

    Args:
        model: G.
        numerator: (..., c), of C in z^-1, lowest power first.
        denominator: (..., e), of C.
        gain: shape; K.
    """
    b, a = model_polynomials(model)
    cb, ca = np.asarray(numerator, dtype=float), np.asarray(denominator, dtype=float)
    with np.errstate(all='ignore'):
        found = _margins(b, a, cb, ca, np.asarray(gain, dtype=float))
    modulus, phase, delay, factor = found
    return Margins(modulus, phase, np.asarray(delay) * model.dt, factor)


def loop_response(
    plant: Complex, numerator: ArrayLike, denominator: ArrayLike, gain: float, omega: ArrayLike
) -> Complex:
    """Give L = K C G (f,) of u = -K C y.

    Args:
        plant: (f,) G at e^{j omega}.
        numerator, denominator: of C in z^-1, lowest power first.
        gain: K.
        omega: (f,) rad/sample.
    """
    zi = np.exp(-1j * np.asarray(omega, dtype=float))
    law = [value(numerator, z) / value(denominator, z) for z in zi.ravel().tolist()]
    return np.asarray(gain * np.reshape(law, zi.shape) * plant)
