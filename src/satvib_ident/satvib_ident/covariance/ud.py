# SPDX-FileCopyrightText: 2026 The satvib authors
# SPDX-License-Identifier: Apache-2.0
"""A covariance that cannot lose symmetry or definiteness: P = U D U^T.

U is unit upper triangular and D is diagonal and positive, so P is symmetric positive definite whatever the rounding.
The estimators change P by these operations only:

    measure   P <- Pb - Pb w (1 + w^T Pb w)^-1 w^T Pb,  Pb = P / lambda     Eqs. (26), (27); Bierman 1977
    add       P <- P + c v v^T, c > 0                                       Agee and Turner 1972
    weigh     w^T P^-1 w

`measure` also moves the estimate, Eq. (25): theta <- theta + K e. Nothing else in the package does. Forgetting changes
lambda and P before it.

The functions named `_one` work on one item, inside kernels. They are inlined, because a call with arrays costs as much
as their arithmetic.

G. J. Bierman, Factorization Methods for Discrete Sequential Estimation, Academic Press, 1977, sections III.4 and V.3.
"""

import numpy as np
from satvib_common.arrays import Array
from satvib_common.kernels.compile import kernel
from satvib_common.kernels.deferred import njit
from satvib_common.kernels.ud import LARGEST, measure_one


@njit(inline='always')
def add_one(c, U, d, work):
    """P <- P + c v v^T for one item; `work` holds v and is used up."""
    for j in range(d.shape[0] - 1, -1, -1):
        s = work[j]
        old = d[j]
        new = min(old + c * s * s, LARGEST)
        d[j] = new
        slope = c * s / new
        for i in range(j):
            entry = U[i, j]
            work[i] -= s * entry
            changed = entry + slope * work[i]
            if abs(changed) < LARGEST:
                U[i, j] = changed
        c *= old / new


@njit(inline='always')
def trace_of(U, d):
    """Trace of P."""
    total = 0.0
    for j in range(d.shape[0]):
        column = 1.0
        for i in range(j):
            column += U[i, j] * U[i, j]
        total += d[j] * column
    return total


@njit(inline='always')
def grown_scale(forgetting, limit, U, d):
    """1 / lambda, with lambda raised where forgetting would take the trace of P beyond its limit."""
    if forgetting < 1.0:
        return 1.0 / max(forgetting, min(1.0, trace_of(U, d) / limit))
    return 1.0


@kernel(
    'void(f8[:], f8, f8, f8, b1, f8[:], f8[:,:], f8[:], f8[:], f8[:])',
    '(p),(),(),(),(),(p),(p,p),(p)->(p),()',
    writable=('theta', 'U', 'd'),
)
def measure(w, error, forgetting, limit, active, theta, U, d, gain, alpha):
    """One recursive least-squares update of (theta, U, d), in place.

    Args:
        w: (p) regressor of the gain.
        error: () prediction error e(k) = y - w^T theta.
        forgetting: () lambda in (0, 1].
        limit: () largest trace of P; lambda is raised where forgetting would pass it.
        active: () bool; nothing changes where it is false.
        theta: (p) estimate, changed.
        U: (p, p) unit upper triangular factor, changed.
        d: (p) diagonal factor, changed.
        gain: (p) out, K(k); 0 where nothing changed.
        alpha: () out, 1 + w^T (P / lambda) w; 0 where inactive; -1 where the sample was refused because it is not
            finite or beyond all bounds (U^T w above 1e60, an error above 1e100).
    """
    if not active:
        alpha[0] = 0.0
        for j in range(d.shape[0]):
            gain[j] = 0.0
        return
    alpha[0] = measure_one(w, error, grown_scale(forgetting, limit, U, d), theta, U, d, gain)
    if alpha[0] < 0.0:
        gain[:] = 0.0


@njit(inline='always')
def forget_one(directions, forgetting, limit, U, d, work):
    """Forget in a subspace only, for one item: see `forget_within`."""
    rows, p = directions.shape
    grown = trace_of(U, d)
    for r in range(rows):  # work[r] = D^-1/2 U^-1 v, made orthonormal
        for j in range(p):
            work[r, j] = directions[r, j]
        before = 0.0
        for j in range(p - 1, -1, -1):
            for i in range(j):
                work[r, i] -= work[r, j] * U[i, j]
            work[r, j] /= np.sqrt(d[j])
            before += work[r, j] * work[r, j]
        if not 0.0 < before < 1e280:
            before = 0.0
        for _ in range(2):
            for q in range(r):
                share = 0.0
                for j in range(p):
                    share += work[r, j] * work[q, j]
                for j in range(p):
                    work[r, j] -= share * work[q, j]
        after = 0.0
        for j in range(p):
            after += work[r, j] * work[r, j]
        good = before > 0.0 and after > 1e-20 * before
        for j in range(p):
            work[r, j] = work[r, j] / np.sqrt(after) if good else 0.0
    for r in range(rows):  # back to U D^1/2 x: the columns to add
        for j in range(p):
            work[r, j] *= np.sqrt(d[j])
        for i in range(p):
            total = work[r, i]
            for j in range(i + 1, p):
                total += U[i, j] * work[r, j]
            work[r, i] = total
            grown += (1.0 / forgetting - 1.0) * total * total
    if not grown < limit:
        return
    for r in range(rows):
        add_one(1.0 / forgetting - 1.0, U, d, work[r])


@kernel(
    'void(f8[:,:], f8, f8, b1, f8[:,:], f8[:], f8[:,:])',
    '(r,p),(),(),(),(p,p),(p)->(r,p)',
    writable=('U', 'd'),
)
def forget_within(directions, forgetting, limit, active, U, d, work):
    """Forget in a subspace only: P <- P + (1/lambda - 1) V (V^T P^-1 V)^-1 V^T, in place.

    The directions are made orthogonal in the sense of P^-1 one after the other (modified Gram-Schmidt on U^-1 v), so
    each adds (1/lambda - 1) v v^T / (v^T P^-1 v). Information in the subspace falls to lambda times itself; what
    P^-1 holds orthogonal to it stays. If the directions span everything this is exponential forgetting.

    Args:
        directions: (r, p) rows v; a row of zeros is none.
        forgetting: () lambda in (0, 1].
        limit: () largest trace of P; nothing is forgotten beyond it.
        active: () bool; nothing changes where it is false.
        U: (p, p) unit upper triangular factor, changed.
        d: (p) diagonal factor, changed.
        work: (r, p) out, for the kernel alone.
    """
    work[:, :] = 0.0
    if active and forgetting < 1.0:
        forget_one(directions, forgetting, limit, U, d, work)


@kernel('void(f8[:,:], f8[:], f8[:,:])', '(p,p),(p)->(p,p)')
def _assemble(U, d, P):
    p = d.shape[0]
    lift = 1.0 + 1.8e-15 * p * p
    for i in range(p):
        for j in range(i, p):
            total = 0.0
            for k in range(j, p):
                left = 1.0 if k == i else U[i, k]
                right = 1.0 if k == j else U[j, k]
                total += left * d[k] * right
            P[i, j] = total
            P[j, i] = total
        P[i, i] *= lift


def covariance(U: Array, d: Array) -> Array:
    """P = U D U^T, (..., p, p), the same above and below the diagonal to the last bit.

    The diagonal is 16 p^2 units of rounding larger than computed (4.5e-14 for five parameters): so much that the
    rounded matrix is positive definite too and its Cholesky factorization in double precision succeeds, whatever its
    condition (N. J. Higham, Accuracy and Stability of Numerical Algorithms, 2002, theorem 10.7).
    """
    return np.asarray(_assemble(U, d))


def fresh(covariance: Array, shape: tuple[int, ...]) -> tuple[Array, Array]:
    """Factors (U, d) of a diagonal covariance (p) for every item of `shape`."""
    p = covariance.shape[-1]
    U = np.broadcast_to(np.eye(p), (*shape, p, p)).copy()
    return U, np.broadcast_to(covariance, (*shape, p)).copy()
