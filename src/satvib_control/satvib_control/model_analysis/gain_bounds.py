# SPDX-FileCopyrightText: 2026 The satvib authors
# SPDX-License-Identifier: Apache-2.0
"""The interval of a gain that an identified model proves stable with a modulus margin.

The loop is u = -K C(z) y on y = G(z) u + d, with G and C stable. With L = C G, the modulus margin is the distance of
the Nyquist curve from -1, min_w |1 + K L(w)| = 1 / max |S|. For each frequency

    |1 + K L|^2 = 1 + 2 K Re L + K^2 |L|^2 >= mu^2

is a quadratic in K, so the gains that violate it are an open interval between its real roots, both of one sign. The
largest interval around 0 that no frequency violates is

    ( max over w of the negative roots next to 0, min over w of the positive roots next to 0 ).

Inside it the loop is stable. It is stable at K = 0, and when K changes no closed-loop pole can cross the unit circle
while |1 + K L| >= mu > 0 for every w. The minimum is taken on a grid and refined by golden section around each local
one.

With a covariance of the model's parameters the Nyquist curve becomes a tube. To first order L moves by J dtheta. At
each frequency that is an ellipse, whose largest semi-axis at the wanted confidence is rho(w). The condition becomes

    |1 + K L| >= mu + |K| rho,

again a quadratic for each sign of K: the worst case over the confidence ellipsoid at each frequency.

Source: Garcia, Karimi, Longchamp, "Robust controller design by linear programming", and Landau et al., Adaptive
Control, 2nd ed., section 8.3 (modulus margin), in the scalar form above.
"""

import math
from dataclasses import dataclass
from typing import TYPE_CHECKING, NamedTuple

import numpy as np
from numpy.typing import ArrayLike
from satvib_common.arrays import Array, Mask
from satvib_common.kernels.compile import kernel
from satvib_common.kernels.deferred import njit
from satvib_common.kernels.horner_rule import horner
from satvib_common.special import chi_squared_below

from satvib_control.model_analysis.transfer import model_polynomials, multiply, stable

if TYPE_CHECKING:
    from satvib_ident.models.iir_model import IirModel


LOWEST = 1e-4  # first point of the grid, as a share of the sample rate
POINTS = 800
OUTSIDE = 1.005  # radius
GOLDEN = (math.sqrt(5.0) - 1.0) / 2.0


@dataclass(frozen=True)
class GainBounds:
    """The interval in which a gain keeps the margin.

    Attributes:
        minimum: shape; not above 0.
        maximum: shape; not below 0. Both are 0 where the model or the controller is itself not stable.
    """

    minimum: Array
    maximum: Array

    def project(self, gain: ArrayLike) -> Array:
        """Give the nearest gain (shape) inside."""
        return np.minimum(np.maximum(gain, self.minimum), self.maximum)


class _Loop(NamedTuple):
    """One loop.

    Attributes:
        a, b: of the model.
        delay: samples.
        cb, ca: polynomials of the controller C.
        covariance: (n + m, n + m) scaled to the confidence ellipsoid, or 0 x 0 for none.
        margin: mu.
    """

    a: Array
    b: Array
    delay: float
    cb: Array
    ca: Array
    covariance: Array
    margin: float


@njit
def _semi_axis(loop, zi, zd, c, g, den):
    """The largest semi-axis rho of the ellipse of C G at one frequency, for a covariance that is there."""
    covariance = loop.covariance
    n, size = loop.a.shape[0], covariance.shape[0]
    re = np.empty(size)
    im = np.empty(size)
    power = zi
    for i in range(n):
        j = -c * g * power / den
        re[i], im[i] = j.real, j.imag
        power = power * zi
    power = zd
    for i in range(loop.b.shape[0]):
        j = c * power / den
        re[n + i], im[n + i] = j.real, j.imag
        power = power * zi
    rr = 0.0
    ri = 0.0
    ii = 0.0
    for i in range(size):
        for j in range(size):
            rr += re[i] * covariance[i, j] * re[j]
            ri += re[i] * covariance[i, j] * im[j]
            ii += im[i] * covariance[i, j] * im[j]
    half = 0.5 * (rr + ii)
    return math.sqrt(max(half + math.sqrt(0.25 * (rr - ii) * (rr - ii) + ri * ri), 0.0))


@njit
def _limit(f, sign, loop):
    """Smallest |K| of a sign (-1 or 1) that violates the margin at f, a share of the sample rate."""
    w = 2.0 * math.pi * f
    zi = complex(math.cos(w), -math.sin(w))
    den = 1.0 + zi * horner(loop.a, zi)
    zd = complex(math.cos(w * loop.delay), -math.sin(w * loop.delay))
    c = horner(loop.cb, zi) / horner(loop.ca, zi)
    g = zd * horner(loop.b, zi) / den
    response = c * g
    rho = 0.0
    if loop.covariance.shape[0] > 0:
        rho = _semi_axis(loop, zi, zd, c, g, den)
    # (|L|^2 - rho^2) k^2 + 2 (Re - mu rho) k + 1 - mu^2 >= 0 for k = |K|
    p = response.real * response.real + response.imag * response.imag - rho * rho
    q = sign * response.real - loop.margin * rho
    r = 1.0 - loop.margin * loop.margin
    root = q * q - p * r
    if root < 0.0:
        return np.inf
    root = math.sqrt(root)
    if q >= 0.0:
        # both roots negative when p > 0; one positive when p < 0
        return (q + root) / -p if p < 0.0 else np.inf
    return r / (-q + root)


@njit
def _refined(left, right, sign, loop):
    """Smallest limit between two logarithms of f, by golden section."""
    best = np.inf
    for _ in range(40):
        x1 = right - GOLDEN * (right - left)
        x2 = left + GOLDEN * (right - left)
        f1 = _limit(math.exp(x1), sign, loop)
        f2 = _limit(math.exp(x2), sign, loop)
        best = min(best, f1, f2)
        if f1 < f2:
            right = x2
        else:
            left = x1
    return best


@njit
def _smallest(sign, loop):
    """Smallest limit over all frequencies, of one sign of K."""
    start = math.log(LOWEST)
    step = (math.log(0.5) - start) / (POINTS - 1)
    grid = np.empty(POINTS)
    best = np.inf
    for i in range(POINTS):
        grid[i] = _limit(math.exp(start + step * i), sign, loop)
        best = min(best, grid[i])
    for i in range(POINTS):
        low, high = max(i - 1, 0), min(i + 1, POINTS - 1)
        # only minima that could still be the smallest are refined
        if grid[i] > 1.5 * best or grid[i] > grid[low] or grid[i] > grid[high]:
            continue
        best = min(best, _refined(start + step * low, start + step * high, sign, loop))
    return best


@kernel(
    'void(f8[:], f8[:], f8, f8[:], f8[:], f8[:,:], f8, f8[:], f8[:])',
    '(n),(m),(),(c),(e),(q,q),()->(),()',
)
def _bounds(a, b, delay, cb, ca, covariance, margin, low, high):
    """Interval of one item; see `_Loop`."""
    loop = _Loop(a, b, delay, cb, ca, covariance, margin)
    low[0] = -_smallest(-1.0, loop)
    high[0] = _smallest(1.0, loop)


def gain_bounds(
    model: 'IirModel',
    numerator: ArrayLike,
    denominator: ArrayLike,
    margin: float,
    covariance: ArrayLike | None = None,
    confidence: float = 0.99,
) -> GainBounds:
    """Give the interval of K for u = -K C(z) y.

    Args:
        model: G, one or a batch.
        numerator: (..., c), of C in z^-1, lowest power first.
        denominator: (..., e), of C.
        margin: modulus margin, in (0, 1).
        covariance: (..., n + m, n + m) of (a1..an, b1..bm); None or NaN: the model is taken as it is.
        confidence: of the ellipsoid that the covariance spans.
    """
    a, b = np.asarray(model.a, dtype=float), np.asarray(model.b, dtype=float)
    cb, ca = np.asarray(numerator, dtype=float), np.asarray(denominator, dtype=float)
    size = a.shape[-1] + b.shape[-1]
    if covariance is None:
        cov = np.zeros((0, 0))
    else:
        quantile = chi_squared_below(size, confidence)
        cov = np.asarray(covariance, dtype=float) * quantile
        cov = np.where(np.isfinite(cov), cov, 0.0)
    with np.errstate(all='ignore'):
        low, high = _bounds(a, b, float(model.delay), cb, ca, cov, margin)
        good = (stable(model_polynomials(model)[1]) * stable(ca)) > 0.0
    bounds = np.stack([low, high])
    bounds = np.where(good & np.isfinite(bounds) & _stable_with(bounds, model, cb, ca), bounds, 0.0)
    return GainBounds(bounds[0, ...], bounds[1, ...])


def _stable_with(gain: Array, model: 'IirModel', cb: Array, ca: Array) -> Mask:
    """Whether the closed loop is stable with a gain (..., *shape of the model).

    Two resonances of nearly the same frequency forbid gains in a band narrower than the grid. Then the grid has missed
    it, the loop is not stable at the bound, and nothing is proven. Poles up to `OUTSIDE` count as stable: at a high
    sample rate many poles lie so near to 1 that rounding moves them by as much.
    """
    b, a = model_polynomials(model)
    open_loop, closed = multiply(a, ca), multiply(b, cb)
    length = max(open_loop.shape[-1], closed.shape[-1])
    open_loop, closed = (
        np.concatenate([p, np.zeros((*p.shape[:-1], length - p.shape[-1]))], axis=-1)
        for p in (open_loop, closed)
    )
    finite = np.where(np.isfinite(gain), gain, 0.0)[..., None]
    with np.errstate(all='ignore'):
        loop = (open_loop + finite * closed) * OUTSIDE ** -np.arange(length)
        return np.asarray(stable(loop) > 0.0)
