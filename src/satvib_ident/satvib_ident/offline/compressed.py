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

BLOCK = 8192  # rows factorized at once
RANK = 1e-13  # a singular value below this share of the largest is rounding

Column = tuple[str, int]
ONE: Column = ('1', 0)
Progress = Callable[[float, str], None]


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
        if not lags:
            continue
        absent = np.concatenate([[0], np.cumsum(~np.isfinite(values))])
        k = np.arange(len(y))
        last, first = k - lags[0], k - lags[-1]
        inside = (first >= 0) & (last < len(y))
        last, first = np.clip(last, 0, len(y) - 1), np.clip(first, 0, len(y) - 1)
        out &= inside & (absent[last + 1] - absent[first] == 0)
    return out


def matrix(y: Array, u: Array, columns: Sequence[Column], rows: Integers) -> Array:
    """Rows of the delayed copies, (rows, columns); every sample that they need must exist."""
    out = np.empty((len(rows), len(columns)), order='F')
    for j, (name, lag) in enumerate(columns):
        out[:, j] = 1.0 if name == '1' else (y if name == 'y' else u)[rows - lag]
    return out


def triangle(
    y: Array,
    u: Array,
    columns: Sequence[Column],
    rows: Integers,
    progress: Progress = quiet,
    start: Array | None = None,
) -> Array:
    """R of the rows, (at most columns, columns), continued from `start`."""
    R = np.zeros((0, len(columns))) if start is None else start
    for first in range(0, len(rows), BLOCK):
        block = matrix(y, u, columns, rows[first : first + BLOCK])
        R = np.linalg.qr(np.vstack([R, block]), mode='r')
        progress((first + len(block)) / len(rows), 'one pass for all orders')
    return R


def regress(R: Array, target: int, given: Sequence[int], rows: int) -> Regression:
    """Regress one column of a triangle on others.

    Args:
        R: (r, columns).
        target: which column.
        given: on which columns.
        rows: samples that R stands for.
    """
    given = list(given)
    small = np.linalg.qr(np.column_stack([R[:, given], R[:, target]]), mode='r')
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
