# SPDX-FileCopyrightText: 2026 The satvib authors
# SPDX-License-Identifier: Apache-2.0
"""The matrix exponential of small, sparse-in-blocks matrices, for designs by the thousand.

A campaign designs a rig per trial. A general library call costs milliseconds there, takes all cores, and may round
differently with their number; this kernel is one plain loop per matrix, and skips what is zero, which a cascade of
mechanics, coils, filters and inputs mostly is (zero blocks stay zero under products).

Balancing by powers of two (Osborne 1960, J. ACM 7, 338), scaling to a norm of 1/2 at most, Taylor to degree 16 (its
remainder is below 1e-19), squaring.
"""

import numpy as np
from satvib_common.kernels.compile import kernel
from satvib_common.kernels.deferred import njit


@njit
def _balance(a, scale):
    """Scale a by a diagonal of powers of two so that its rows and columns weigh alike; fill `scale`."""
    size = a.shape[0]
    scale[:] = 1.0
    for _ in range(6):
        for i in range(size):
            row = 0.0
            column = 0.0
            for j in range(size):
                if j != i:
                    row += abs(a[i, j])
                    column += abs(a[j, i])
            if row == 0.0 or column == 0.0:
                continue
            factor = 1.0
            while column * factor * factor * 2.0 < row:
                factor *= 2.0
            while column * factor * factor > row * 2.0:
                factor *= 0.5
            scale[i] *= factor
            for j in range(size):
                a[i, j] /= factor
            for j in range(size):
                a[j, i] *= factor


@njit
def _product(a, b, c):
    """C = a b, without what is zero in a."""
    size = a.shape[0]
    for i in range(size):
        for j in range(size):
            c[i, j] = 0.0
        for k in range(size):
            weight = a[i, k]
            if weight != 0.0:
                for j in range(size):
                    c[i, j] += weight * b[k, j]


@kernel('void(f8[:,:],f8[:,:])', '(m,m)->(m,m)')
def exponential(matrix, result):
    """Give exp(matrix) for (..., m, m)."""
    size = matrix.shape[0]
    a = matrix.copy()
    scale = np.empty(size)
    _balance(a, scale)
    norm = 0.0
    for i in range(size):
        row = 0.0
        for j in range(size):
            row += abs(a[i, j])
        norm = max(norm, row)
    squarings = 0
    while norm > 0.5:
        norm *= 0.5
        squarings += 1
    for i in range(size):
        for j in range(size):
            a[i, j] *= 0.5**squarings
    x = np.eye(size)
    y = np.empty((size, size))
    for term in range(16, 0, -1):
        _product(a, x, y)
        for i in range(size):
            for j in range(size):
                x[i, j] = y[i, j] / term
            x[i, i] += 1.0
    for _ in range(squarings):
        _product(x, x, y)
        x, y = y, x
    for i in range(size):
        for j in range(size):
            result[i, j] = x[i, j] * scale[i] / scale[j]
