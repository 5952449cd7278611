# SPDX-FileCopyrightText: 2026 The satvib authors
# SPDX-License-Identifier: Apache-2.0
"""A covariance that cannot lose symmetry or definiteness: P = U D U^T.

U is unit upper triangular and D is diagonal and positive, so P is symmetric positive definite whatever rounding does
to the numbers inside. Everything that the estimators do to P is made of these operations:

    measure   P <- Pb - Pb w (1 + w^T Pb w)^-1 w^T Pb,  Pb = P / lambda     Eqs. (26), (27); Bierman 1977
    add       P <- P + c v v^T, c > 0                                       Agee and Turner 1972
    weigh     w^T P^-1 w

`measure` also moves the estimate, Eq. (25): theta <- theta + K e. It is the only place of the package where that is
done; forgetting is what happens to lambda and P before it.

G. J. Bierman, Factorization Methods for Discrete Sequential Estimation, Academic Press, 1977, sections III.4 and V.3.
"""

import numpy as np
from numpy.typing import NDArray
from satvib_common.kernel import kernel

# Elements are kept within these, so that neither a million strong samples nor a million silent ones reach 0 or
# infinity.
SMALLEST = 1e-150
LARGEST = 1e150


@kernel(
    'void(f8[:], f8, f8, f8, b1, f8[:], f8[:,:], f8[:], f8[:], f8[:])',
    '(p),(),(),(),(),(p),(p,p),(p)->(p),()',
    writable=('theta', 'U', 'd'),
)
def measure(w, error, forgetting, limit, active, theta, U, d, gain, alpha):  # type: ignore[no-untyped-def]  # noqa: ANN001, ANN201
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
            finite, or so large that its square is not.
    """
    p = d.shape[0]
    alpha[0] = 0.0
    for j in range(p):
        gain[j] = 0.0
    if not active:
        return
    scale = 1.0
    if forgetting < 1.0:
        trace = 0.0
        for j in range(p):
            column = 1.0
            for i in range(j):
                column += U[i, j] * U[i, j]
            trace += d[j] * column
        scale = 1.0 / max(forgetting, min(1.0, trace / limit))
    total = 1.0  # look before anything is changed
    for j in range(p):
        f = w[j]
        for i in range(j):
            f += U[i, j] * w[i]
        total += f * f * (d[j] * scale)
    if not (total < 1e280 and abs(error) < 1e140):
        alpha[0] = -1.0
        return
    before = 1.0
    for j in range(p):
        f = w[j]
        for i in range(j):
            f += U[i, j] * w[i]
        old = d[j] * scale
        v = old * f
        after = before + f * v
        d[j] = min(max(old * (before / after), SMALLEST), LARGEST)
        ratio = -f / before
        for i in range(j):
            entry = U[i, j]
            changed = entry + gain[i] * ratio
            if abs(changed) < LARGEST:
                U[i, j] = changed
            gain[i] += entry * v
        gain[j] = v
        before = after
    for j in range(p):
        gain[j] /= before
        moved = theta[j] + gain[j] * error
        if abs(moved) < LARGEST:
            theta[j] = moved
    alpha[0] = before


@kernel(
    'void(f8[:], f8, b1, f8[:,:], f8[:], f8[:])', '(p),(),(),(p,p),(p)->(p)', writable=('U', 'd')
)
def add(v, c, active, U, d, work):  # type: ignore[no-untyped-def]  # noqa: ANN001, ANN201
    """P <- P + c v v^T in place, c >= 0, where `active` holds; `work` (p) comes out as U^-1 v."""
    p = d.shape[0]
    for j in range(p):
        work[j] = v[j]
    good = active and c > 0.0 and c < LARGEST
    rest = c
    for j in range(p - 1, -1, -1):
        s = work[j]
        old = d[j]
        new = old
        if good:
            new = min(old + rest * s * s, LARGEST)
            d[j] = new
        for i in range(j):
            entry = U[i, j]
            work[i] -= s * entry
            if good:
                changed = entry + rest * s / new * work[i]
                if abs(changed) < LARGEST:
                    U[i, j] = changed
        rest *= old / new


@kernel('void(f8[:], f8[:,:], f8[:], f8[:], f8[:])', '(p),(p,p),(p)->(p),()')
def weigh(w, U, d, work, out):  # type: ignore[no-untyped-def]  # noqa: ANN001, ANN201
    """w^T P^-1 w, (); `work` (p) comes out as U^-1 w."""
    p = d.shape[0]
    total = 0.0
    for j in range(p):
        work[j] = w[j]
    for j in range(p - 1, -1, -1):
        for i in range(j):
            work[i] -= work[j] * U[i, j]
        total += work[j] * work[j] / d[j]
    out[0] = total


@kernel('void(f8[:], f8[:], f8[:])', '(p),(p)->()')
def dot(a, b, out):  # type: ignore[no-untyped-def]  # noqa: ANN001, ANN201
    """a^T b, (), summed in order."""
    total = 0.0
    for i in range(a.shape[0]):
        total += a[i] * b[i]
    out[0] = total


@kernel('void(f8[:,:], f8[:], f8[:,:])', '(p,p),(p)->(p,p)')
def _assemble(U, d, P):  # type: ignore[no-untyped-def]  # noqa: ANN001, ANN202
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


def covariance(U: NDArray[np.float64], d: NDArray[np.float64]) -> NDArray[np.float64]:
    """P = U D U^T, (..., p, p), the same above and below the diagonal to the last bit.

    The diagonal is 16 p^2 units of rounding larger than computed (4e-14 for five parameters): so much that the
    rounded matrix is positive definite too and its Cholesky factorization in double precision succeeds, whatever its
    condition (N. J. Higham, Accuracy and Stability of Numerical Algorithms, 2002, theorem 10.7).
    """
    return np.asarray(_assemble(U, d))


def fresh(
    covariance: NDArray[np.float64], shape: tuple[int, ...]
) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Factors (U, d) of a diagonal covariance (p) for every item of `shape`."""
    p = covariance.shape[-1]
    U = np.broadcast_to(np.eye(p), (*shape, p, p)).copy()
    return U, np.broadcast_to(covariance, (*shape, p)).copy()
