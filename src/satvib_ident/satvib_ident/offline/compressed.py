# SPDX-FileCopyrightText: 2026 The satvib authors
# SPDX-License-Identifier: Apache-2.0
"""A record as one small triangle, from which every least-squares model of it follows.

The columns are delayed copies of both signals and a column of ones; the rows are all samples at which every copy is
known. R of W = Q R (Householder, block by block) keeps all inner products without squaring the condition, so the
regression of any column on any others is a regression of columns of R: all orders, all delays, with and without a
constant term, from one pass over the record.

G. H. Golub and C. F. Van Loan, Matrix Computations, 2013, section 5.2; T. Soederstroem and P. Stoica, System
Identification, 1989, complement C4.1 (orders from one factor).
"""

from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np
from satvib_common.arrays import Array, Integers, Mask
from satvib_common.kernels.compile import kernel

BLOCK = 1024  # rows factorized at once, few enough for the cache
RANK = 1e-13  # a singular value below this share of the largest is rounding

Column = tuple[str, int]
ONE: Column = ('1', 0)
Progress = Callable[[float, str], None]


@kernel('void(f8[:,:], f8[:,:], b1[:])', '(q,q),(q,r)->()', writable=('R', 'block'))
def _absorb(R, block, done):
    """Turn [R; block^T] into a triangle by Householder reflections; `block` is used up.

    R is a triangle already, so the reflection of column j moves its row j and the rows of the block only.
    """
    q, r = block.shape
    for j in range(q):
        column = block[j]
        s0, s1, s2, s3 = 0.0, 0.0, 0.0, 0.0  # four sums, which do not wait for one another
        for k in range(0, r - 3, 4):
            s0 += column[k] * column[k]
            s1 += column[k + 1] * column[k + 1]
            s2 += column[k + 2] * column[k + 2]
            s3 += column[k + 3] * column[k + 3]
        for k in range(r - r % 4, r):
            s0 += column[k] * column[k]
        below = (s0 + s1) + (s2 + s3)
        if below == 0.0:
            continue
        head = R[j, j]
        size = np.sqrt(head * head + below)
        alpha = -size if head > 0.0 else size
        first = head - alpha
        factor = 2.0 / (first * first + below)
        R[j, j] = alpha
        for i in range(j + 1, q):
            other = block[i]
            s0, s1, s2, s3 = 0.0, 0.0, 0.0, 0.0
            for k in range(0, r - 3, 4):
                s0 += column[k] * other[k]
                s1 += column[k + 1] * other[k + 1]
                s2 += column[k + 2] * other[k + 2]
                s3 += column[k + 3] * other[k + 3]
            for k in range(r - r % 4, r):
                s0 += column[k] * other[k]
            share = factor * (first * R[j, i] + ((s0 + s1) + (s2 + s3)))
            R[j, i] -= share * first
            for k in range(r):
                other[k] -= share * column[k]
    done[0] = True


@kernel('void(f8[:], i8, i8, b1[:], b1[:])', '(t),(),(),(t)->()', writable=('known',))
def _all_known(x, newest, oldest, known, done):
    """Clear `known` at the samples k at which one of x(k - oldest) .. x(k - newest) does not exist or is not finite."""
    size = x.shape[0]
    last_bad = -1
    for k in range(size):
        place = k - newest
        if place >= 0 and not abs(x[place]) < np.inf:
            last_bad = place
        if k - oldest <= last_bad or k - oldest < 0:
            known[k] = False
    done[0] = True


@dataclass(frozen=True, eq=False)
class Regression:
    """A column as a combination of others.

    Attributes:
        theta: (p) coefficients; the shortest of all solutions where the columns are dependent.
        deviation: (p) standard deviations; infinite where the columns leave a coefficient open.
        squares: sum of what is left.
        rows: samples used.
        rank: independent columns.
    """

    theta: Array
    deviation: Array
    squares: float
    rows: int
    rank: int

    @property
    def variance(self) -> float:
        """Of what is left; NaN until there are more rows than coefficients."""
        freedom = self.rows - len(self.theta)
        return self.squares / freedom if freedom > 0 else float('nan')


def quiet(share: float, what: str) -> None:
    """Show no progress."""
    del share, what


def known_rows(y: Array, u: Array, columns: Sequence[Column]) -> Mask:
    """Whether all of `columns` are known at a sample, (samples)."""
    out = np.ones(len(y), dtype=bool)
    for name, values in (('y', y), ('u', u)):
        lags = sorted(lag for kind, lag in columns if kind == name)
        if lags:
            _all_known(values, lags[0], lags[-1], out)
    return out


def matrix(y: Array, u: Array, columns: Sequence[Column], rows: Integers) -> Array:
    """Rows of the delayed copies, transposed, (columns, rows); every sample that they need must exist."""
    out = np.empty((len(columns), len(rows)))
    for j, (name, lag) in enumerate(columns):
        out[j] = 1.0 if name == '1' else (y if name == 'y' else u)[rows - lag]
    return out


def triangle(
    y: Array,
    u: Array,
    columns: Sequence[Column],
    rows: Integers,
    progress: Progress = quiet,
    start: Array | None = None,
) -> Array:
    """R of the rows, (columns, columns), continued from `start`."""
    R = np.zeros((len(columns), len(columns)))
    if start is not None:
        _absorb(R, np.ascontiguousarray(start.T))
    for first in range(0, len(rows), BLOCK):
        _absorb(R, matrix(y, u, columns, rows[first : first + BLOCK]))
        if first % (64 * BLOCK) == 0:
            progress(first / len(rows), 'one pass for all orders')
    return R


def upper(W: Array) -> Array:
    """R of a small matrix."""
    return np.asarray(np.linalg.qr(W, mode='r'))


def regress(R: Array, target: int, given: Sequence[int], rows: int) -> Regression:
    """Regress one column of a triangle on others.

    Args:
        R: (r, columns).
        target: which column.
        given: on which columns.
        rows: samples that R stands for.
    """
    given = list(given)
    small = upper(np.column_stack([R[:, given], R[:, target]]))
    p = len(given)
    W, goal = small[:, :p], small[:, p]
    size = np.sqrt(np.sum(W * W, axis=0))
    size[size == 0.0] = 1.0  # columns of one length: the rank then does not depend on units
    left, s, right = np.linalg.svd(W / size, full_matrices=False)
    good = s > RANK * (s[0] if len(s) else 0.0)
    theta = right.T[:, good] @ ((left.T[good] @ goal) / s[good]) / size
    rest = goal - W @ theta
    squares = float(rest @ rest)
    freedom = rows - p
    with np.errstate(divide='ignore', invalid='ignore'):
        spread = np.sum((right[good].T / s[good]) ** 2, axis=1)
        spread = np.where(np.sum(right[~good] ** 2, axis=0) > 1e-12, np.inf, spread)
        if p > len(s):
            spread[:] = np.inf
        deviation = np.sqrt(spread * (squares / freedom if freedom > 0 else np.nan)) / size
    return Regression(theta, deviation, squares, rows, int(good.sum()))
