# SPDX-FileCopyrightText: 2026 The satvib authors
# SPDX-License-Identifier: Apache-2.0
"""Every candidate of a record, by least squares from one triangle or by a recursion of the node, with offset or not.

All of it in the record's own units (`scaling`), as A(q) y = B(q) u(k - delay) + c.
"""

from dataclasses import dataclass
from typing import Protocol

import numpy as np
from satvib_common.arrays import Array
from satvib_common.errors import SatvibError

from satvib_ident.models.iir_model import IirModel
from satvib_ident.models.polynomials import pole_modulus
from satvib_ident.offline.compressed import (
    ONE,
    Column,
    Progress,
    known_rows,
    quiet,
    regress,
    triangle,
)
from satvib_ident.offline.fits import Fitted, follow
from satvib_ident.offline.recursion import RecordEstimator
from satvib_ident.offline.result import Offset
from satvib_ident.offline.scaling import Scaled, scale

Order = tuple[int, int, int]


@dataclass(frozen=True, eq=False)
class Solution:
    """A(q) y = B(q) u(k - delay) + c in the record's own units.

    Attributes:
        order: poles, coefficients, delay.
        theta: (n + m) a, then b.
        constant: c.
        deviation: (n + m).
        variance: of the one-step errors.
    """

    order: Order
    theta: Array
    constant: float
    deviation: Array
    variance: float

    @property
    def a(self) -> Array:
        """(n)."""
        return self.theta[: self.order[0]]

    @property
    def b(self) -> Array:
        """(m)."""
        return self.theta[self.order[0] :]

    @property
    def stable(self) -> bool:
        """All poles inside the unit circle."""
        return bool(pole_modulus(self.a) < 1.0)


class Variants(Protocol):
    """Solutions of every candidate on the first part and on the whole of a record."""

    y: Scaled
    u: Scaled
    split: int
    columns: list[Column]

    def solve(self, order: Order, offset: Offset, whole: bool) -> Solution:
        """Estimate one candidate, on the whole record or on its first part."""
        ...

    def follow(self, solution: Solution, part: slice) -> Fitted:
        """Run a solution along a part of the record."""
        ...

    def in_units(self, solution: Solution, dt: float) -> tuple[IirModel, Array, float]:
        """Model, deviations of its parameters and c in the units of the record."""
        ...


class _InOwnUnits:
    """What both kinds of variants share.

    Args:
        y: output.
        u: input.
        split: first sample of the validation part.
    """

    def __init__(self, y: Scaled, u: Scaled, split: int) -> None:
        self.y, self.u, self.split = y, u, split

    def follow(self, solution: Solution, part: slice) -> Fitted:
        return follow(
            solution.a,
            solution.b,
            solution.constant,
            solution.order[2],
            self.y.values[part],
            self.u.values[part],
        )

    def in_units(self, solution: Solution, dt: float) -> tuple[IirModel, Array, float]:
        n, _, delay = solution.order
        gain = self.y.unit / self.u.unit
        b = solution.b * gain
        deviation = np.concatenate([solution.deviation[:n], solution.deviation[n:] * gain])
        if not np.isfinite(b).all():
            raise SatvibError('record: the units of input and output are too far apart for numbers')
        constant = (1.0 + solution.a.sum()) * self.y.centre - b.sum() * self.u.centre
        constant += self.y.unit * solution.constant
        return IirModel(solution.a, b, delay, dt), deviation, float(constant)

    def _raw_constant(self, a: Array, b: Array, y_shift: float, u_shift: float) -> float:
        """C of a model without constant between y - y_shift and u - u_shift, own units."""
        return float((1.0 + a.sum()) * y_shift - b.sum() * u_shift)


class LeastSquares(_InOwnUnits):
    """Least squares of all candidates from one triangle.

    Args:
        y: (samples) NaN where missing.
        u: (samples) likewise.
        orders: all that will be asked for.
        split: first sample of the validation part.
        progress: called with the share done.
    """

    def __init__(
        self, y: Array, u: Array, orders: list[Order], split: int, progress: Progress = quiet
    ) -> None:
        super().__init__(scale(y, slice(split)), scale(u, slice(split)), split)
        lags = {lag for _, m, d in orders for lag in range(d, d + m)}
        poles = max(n for n, _, _ in orders)
        self.columns = [
            ONE,
            *(('y', i) for i in range(1, poles + 1)),
            *(('u', i) for i in sorted(lags)),
            ('y', 0),
        ]
        self._rows = known_rows(self.y.values, self.u.values, self.columns)
        rows = np.flatnonzero(self._rows)
        first, rest = rows[rows < split], rows[rows >= split]
        values = self.y.values, self.u.values
        half = triangle(
            *values, self.columns, first, lambda share, what: progress(0.5 * share, what)
        )
        whole = triangle(
            *values, self.columns, rest, lambda share, what: progress(0.5 + 0.5 * share, what), half
        )
        self._triangles = {False: half, True: whole}
        self._counts = {False: len(first), True: len(rows)}
        y_known, u_known = (v[np.isfinite(v)] for v in values)
        self._means = float(y_known.mean()), float(u_known.mean())
        self._solved: dict[tuple[Order, Offset, bool], Solution] = {}
        self._small: dict[tuple[Order, bool], tuple[Array, int]] = {}

    @staticmethod
    def columns_of(order: Order) -> list[Column]:
        """The columns of one candidate, the target last."""
        n, m, delay = order
        return [
            ONE,
            *(('y', i) for i in range(1, n + 1)),
            *(('u', delay + i) for i in range(m)),
            ('y', 0),
        ]

    def _triangle(self, order: Order, whole: bool) -> tuple[Array, int]:
        """Triangle of one candidate over all rows that are complete for it, and their number."""
        if (order, whole) not in self._small:
            columns = self.columns_of(order)
            places = [self.columns.index(c) for c in columns]
            small = self._triangles[whole][:, places]
            # rows that are complete for this order and not for the largest
            extra = known_rows(self.y.values, self.u.values, columns) & ~self._rows
            rows = np.flatnonzero(extra if whole else extra[: self.split])
            small = triangle(self.y.values, self.u.values, columns, rows, start=small)
            self._small[order, whole] = small, self._counts[whole] + len(rows)
        return self._small[order, whole]

    def solve(self, order: Order, offset: Offset, whole: bool) -> Solution:
        """Estimate one candidate, once."""
        key = (order, offset, whole)
        if key not in self._solved:
            self._solved[key] = self._solve(order, offset, whole)
        return self._solved[key]

    def _solve(self, order: Order, offset: Offset, whole: bool) -> Solution:
        n, m, _ = order
        R, rows = self._triangle(order, whole)
        p = n + m
        if offset is Offset.CONSTANT:
            found = regress(R, p + 1, range(p + 1), rows)
            theta = found.theta[1:] * _signs(n, m)
            return Solution(
                order, theta, float(found.theta[0]), found.deviation[1:], found.variance
            )
        if offset is Offset.NONE:  # the signals as they were: zero lies at minus the centre
            shift = -self.y.centre / self.y.unit, -self.u.centre / self.u.unit
        else:
            shift = self._means if whole else (0.0, 0.0)
        shifts = np.array([0.0] + n * [shift[0]] + m * [shift[1]] + [shift[0]])
        found = regress(R - np.outer(R[:, 0], shifts), p + 1, range(1, p + 1), rows)
        theta = found.theta * _signs(n, m)
        constant = self._raw_constant(theta[:n], theta[n:], *shift)
        return Solution(order, theta, constant, found.deviation, found.variance)


def _signs(n: int, m: int) -> Array:
    """The columns are y(k - i), the regressor has -y(k - i)."""
    return np.concatenate([-np.ones(n), np.ones(m)])


class Recursions(_InOwnUnits):
    """Extended least squares or the instrumental variable, by the recursions of the node.

    Args:
        of: least squares on the same record.
        method: 'extended' or 'instrumental'.
        offset: NONE or MEANS; fixed, because each variant is a pass of its own.
        progress: called with the share done of an order.
    """

    def __init__(
        self, of: LeastSquares, method: str, offset: Offset, progress: Progress = quiet
    ) -> None:
        super().__init__(of.y, of.u, of.split)
        self.columns = of.columns
        self._method, self._progress = method, progress
        raw = offset is Offset.NONE
        self._shift = (-of.y.centre / of.y.unit, -of.u.centre / of.u.unit) if raw else (0.0, 0.0)
        self._solved: dict[Order, dict[bool, Solution]] = {}

    def solve(self, order: Order, offset: Offset, whole: bool) -> Solution:
        """Estimate one candidate, once, both on the first part and on the whole."""
        del offset
        if order not in self._solved:
            y, u = self.y.values - self._shift[0], self.u.values - self._shift[1]
            run = RecordEstimator(self._method, *order)
            found = {}
            for is_whole, end in ((False, self.split), (True, len(y))):
                run.run(y, u, end, self._progress)
                theta = run.theta
                constant = self._raw_constant(theta[: order[0]], theta[order[0] :], *self._shift)
                variance = float(run.estimator.noise_variance)
                found[is_whole] = Solution(order, theta, constant, run.deviation, variance)
            self._solved[order] = found
        return self._solved[order][whole]
