# SPDX-FileCopyrightText: 2026 The satvib authors
# SPDX-License-Identifier: Apache-2.0
"""Extreme eigenvalues of small symmetric matrices, by cyclic Jacobi rotations; batched, and plain arithmetic only.

G. H. Golub and C. F. Van Loan, Matrix Computations, 2013, section 8.5.
"""

import numpy as np
from satvib_common.arrays import Array
from satvib_common.kernels.compile import kernel
from satvib_common.kernels.deferred import njit


@njit(inline='always')
def rotate(A, V):
    """Make A diagonal in place; rows of V, if it has any, turn with it."""
    p = A.shape[0]
    for _ in range(30):
        off = 0.0
        size = 0.0
        for i in range(p):
            size += A[i, i] * A[i, i]
            for j in range(i):
                off += A[i, j] * A[i, j]
        if off <= 1e-32 * size:
            break
        for i in range(p - 1):
            for j in range(i + 1, p):
                if abs(A[i, j]) < 1e-200:
                    continue
                tau = (A[j, j] - A[i, i]) / (2.0 * A[i, j])
                if abs(tau) > 1e100:  # the square would overflow
                    t = 0.5 / tau
                else:
                    t = 1.0 / (abs(tau) + np.sqrt(1.0 + tau * tau))
                    if tau < 0.0:
                        t = -t
                c = 1.0 / np.sqrt(1.0 + t * t)
                s = t * c
                for k in range(p):
                    left, right = A[k, i], A[k, j]
                    A[k, i] = c * left - s * right
                    A[k, j] = s * left + c * right
                for k in range(p):
                    left, right = A[i, k], A[j, k]
                    A[i, k] = c * left - s * right
                    A[j, k] = s * left + c * right
                if V.shape[0] > 0:
                    for k in range(p):
                        left, right = V[i, k], V[j, k]
                        V[i, k] = c * left - s * right
                        V[j, k] = s * left + c * right


@njit(inline='always')
def _jacobi(A):
    """Smallest and largest eigenvalue; A is used up."""
    p = A.shape[0]
    rotate(A, A[:0])
    low = A[0, 0]
    high = A[0, 0]
    for i in range(1, p):
        low = min(low, A[i, i])
        high = max(high, A[i, i])
    return low, high


@kernel('void(f8[:,:], f8[:,:], f8[:], f8[:])', '(p,p)->(p,p),(),()')
def _extremes(A, work, low, high):
    p = A.shape[0]
    for i in range(p):
        for j in range(p):
            work[i, j] = A[i, j]
    low[0], high[0] = _jacobi(work)


@kernel('void(f8[:,:], f8[:], f8[:,:], f8[:,:], f8[:], f8[:])', '(p,p),(p)->(p,p),(p,p),(),()')
def _information(U, d, inverse, R, low, high):
    p = d.shape[0]
    for j in range(p):  # columns of U^-1
        for i in range(p):
            inverse[i, j] = 1.0 if i == j else 0.0
        for i in range(j - 1, -1, -1):
            total = 0.0
            for k in range(i + 1, j + 1):
                total += U[i, k] * inverse[k, j]
            inverse[i, j] = -total
    for i in range(p):
        for j in range(i, p):
            total = 0.0
            for k in range(i + 1):
                total += inverse[k, i] * inverse[k, j] / d[k]
            R[i, j] = total
    for i in range(p):
        for j in range(i + 1, p):
            R[i, j] /= np.sqrt(R[i, i] * R[j, j])
            R[j, i] = R[i, j]
    for i in range(p):
        R[i, i] = 1.0
    low[0], high[0] = _jacobi(R)


@njit(inline='always')
def is_positive(A, slack):
    """Whether all pivots of a symmetric matrix are above `slack`, so that it is positive definite.

    The upper triangle is looked at and used up.
    """
    p = A.shape[0]
    for k in range(p):
        if not A[k, k] > slack:
            return False
        inverse = 1.0 / A[k, k]
        for i in range(k + 1, p):
            share = A[k, i] * inverse
            for j in range(i, p):
                A[i, j] -= share * A[k, j]
    return True


def extreme_eigenvalues(
    matrix: Array,
) -> tuple[Array, Array]:
    """Smallest and largest eigenvalue (...) of a symmetric matrix (..., p, p)."""
    _, low, high = _extremes(matrix)
    return np.asarray(low), np.asarray(high)


def information_measures(U: Array, d: Array) -> tuple[Array, Array]:
    """How well the data determine the parameters, over all directions.

    The information matrix R = P^-1 is scaled to ones on its diagonal, so that units do not matter.

    Args:
        U: (..., p, p) factor of P.
        d: (..., p) factor of P.

    Returns:
        Smallest eigenvalue (...), 1 at best and 0 at worst, and condition number (...), infinite at worst.
    """
    _, _, low, high = _information(U, d)
    low = np.maximum(low, 0.0)
    with np.errstate(divide='ignore'):
        return np.asarray(low), np.asarray(high / low)
