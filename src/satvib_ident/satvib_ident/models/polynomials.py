# SPDX-FileCopyrightText: 2026 The satvib authors
# SPDX-License-Identifier: Apache-2.0
"""Roots of batches of polynomials, and their largest modulus without them.

The modulus needs no eigenvalues: the Schur-Cohn criterion decides whether all roots of 1 + a1 z^-1 + ... lie inside a
circle, and the radius of the circle is bisected. This is plain arithmetic, so the bits do not depend on the batch.
"""

import numpy as np
from satvib_common.arrays import Array, Complex
from satvib_common.kernels.compile import kernel
from satvib_common.kernels.deferred import njit
from satvib_common.kernels.schur_cohn import inside_circle


def roots(coefficients: Array) -> Complex:
    """Roots in z of c0 + c1 z^-1 + ... + cn z^-n, (..., n), item by item.

    A leading zero coefficient means a root at infinity (inf); an item with a coefficient that is not finite gives
    NaN.
    """
    count = coefficients.shape[-1] - 1
    out = np.full((*coefficients.shape[:-1], count), np.inf, dtype=complex)
    for index in np.ndindex(coefficients.shape[:-1]):
        c = coefficients[index]
        if not np.isfinite(c).all():
            out[index] = np.nan
            continue
        found = np.roots(c)
        # np.roots drops trailing zeros as roots at 0 and leading zeros without trace
        out[index][: found.size] = found
    return out


@njit(inline='always')
def modulus_of(a):
    """Largest modulus of the roots of one polynomial; see `pole_modulus`."""
    n = a.shape[0]
    bound = 0.0
    for i in range(n):
        if not abs(a[i]) < 1e150:
            return np.nan
        bound += abs(a[i])
    if bound == 0.0:
        return 0.0
    if n == 1:
        return abs(a[0])
    if n == 2:
        half = -0.5 * a[0]
        square = half * half - a[1]
        return np.sqrt(a[1]) if square < 0.0 else abs(half) + np.sqrt(square)
    low, high = 0.0, max(1.0, bound)  # Cauchy's bound
    work = np.empty(n)
    for _ in range(64):
        r = 0.5 * (low + high)
        if inside_circle(a, r, work):
            high = r
        else:
            low = r
    return high


@njit(inline='always')
def inside(a, radius):
    """Whether all roots of one polynomial 1 + a1 z^-1 + ... lie inside a circle."""
    n = a.shape[0]
    for i in range(n):
        if not abs(a[i]) < 1e150:
            return False
    if n == 2:  # without roots or divisions
        square = radius * radius
        return abs(a[1]) < square and abs(a[0]) * radius < square + a[1]
    return inside_circle(a, radius, np.empty(n))


@kernel('void(f8[:], f8[:])', '(n)->()')
def _modulus(a, out):
    out[0] = modulus_of(a)


def pole_modulus(a: Array) -> Array:
    """Largest modulus of the roots of 1 + a1 z^-1 + ... + an z^-n, (...).

    Args:
        a: (..., n).

    Returns:
        (...); 0 without roots, NaN where a coefficient is not finite.
    """
    if a.shape[-1] == 0:
        return np.zeros(a.shape[:-1])
    return np.asarray(_modulus(a))
