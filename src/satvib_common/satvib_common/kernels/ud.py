# SPDX-FileCopyrightText: 2026 The satvib authors
# SPDX-License-Identifier: Apache-2.0
"""The measurement update of a covariance that is kept as P = U D U^T.

U is unit upper triangular and D diagonal and positive, so rounding cannot make P lose symmetry or definiteness.

    P <- P - P w (1 + w^T P w)^-1 w^T P,   theta <- theta + K e

The recursion goes over the columns j = 1 .. p with f = U^T w, v = D f and alpha_j = alpha_(j-1) + f_j v_j. What it does
to a column stands in `change_column`. `measure_one` has the scalars of identification: one reciprocal per column, and a
sample that could overflow is refused. `satvib_control.laws.feedforward.fxrls` has its own scalars, with divisions: the
two round differently.

G. J. Bierman, Factorization Methods for Discrete Sequential Estimation, Academic Press, 1977, section V.3.
"""

from satvib_common.kernels.deferred import njit

# Elements are kept within these: neither a million strong samples nor a million silent ones reach 0 or infinity.
SMALLEST = 1e-150
LARGEST = 1e150


@njit(inline='always')
def column_product(j, U, w):
    """Give f_j, element j of U^T w."""
    f = w[j]
    for i in range(j):
        f += U[i, j] * w[i]
    return f


@njit(inline='always')
def bounded(d):
    """Keep an element of D within its bounds."""
    return min(max(d, SMALLEST), LARGEST)


@njit(inline='always')
def change_column(j, v, ratio, U, gain):
    """Change column j of U, and let `gain` grow by it; `ratio` is -f_j / alpha_(j-1)."""
    for i in range(j):
        entry = U[i, j]
        changed = entry + gain[i] * ratio
        if abs(changed) < LARGEST:
            U[i, j] = changed
        gain[i] += entry * v
    gain[j] = v


@njit(inline='always')
def measure_one(w, error, scale, theta, U, d, gain):
    """Update (theta, P) for one item, after P <- P scale.

    Args:
        w: (p) regressor.
        error: () prediction error e.
        scale: () what P is multiplied by first.
        theta: (p) estimate, changed.
        U: (p, p), changed.
        d: (p) diagonal of D, changed.
        gain: (p) out, K.

    Returns:
        alpha = 1 + w^T P w; -1 where the sample is refused, because U^T w is above 1e60 or the error above 1e100.
        Then nothing but `gain` has changed.
    """
    p = d.shape[0]
    for j in range(p):  # gain holds f until its turn comes; look before anything is changed
        f = column_product(j, U, w)
        if not abs(f) < 1e60:
            return -1.0
        gain[j] = f
    if not abs(error) < 1e100:
        return -1.0
    before = 1.0
    inverse = 1.0
    for j in range(p):
        f = gain[j]
        old = d[j] * scale
        v = old * f
        after = before + f * v
        ratio = -f * inverse
        inverse = 1.0 / after
        d[j] = bounded(old * (before * inverse))
        change_column(j, v, ratio, U, gain)
        before = after
    for j in range(p):
        gain[j] *= inverse
        moved = theta[j] + gain[j] * error
        if abs(moved) < LARGEST:
            theta[j] = moved
    return before
