# SPDX-FileCopyrightText: 2026 The satvib authors
# SPDX-License-Identifier: Apache-2.0
"""How many samples an input needs to reach the output: models with every delay compared.

ARX models with four poles, two coefficients and a constant term, for all delays from 0 on, come from one triangle. The
delay with the smallest error is taken where it explains much more than a model without one.

L. Ljung, System Identification, 1999, section 16.5 (delay from models of low order).
"""

from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike
from satvib_common.arrays import Array

from satvib_ident.offline.compressed import (
    ONE,
    Column,
    known_rows,
    regress,
    triangle,
)
from satvib_ident.offline.residuals import centred, correlation
from satvib_ident.offline.scaling import check_record, scale

LONGEST = 100  # samples
ROWS = 20_000  # that are looked at
POLES = 4
GAIN = 1.2  # ratio of error variances from which on a delay counts
ROUNDING = 1e-16  # share of the output's variance below which models do not differ
SURE = 30.0  # N ln(ratio): far beyond chance


@dataclass(frozen=True, eq=False)
class DelaySearch:
    """What was found.

    Attributes:
        delay: samples; 0 where none explains much more than a model without.
        searched: the longest delay compared.
        variance: (searched + 1) error variance of each delay, as a share of the output's.
        without: that of a model with three coefficients and no delay.
        peak: lag at which input and output correlate most.
    """

    delay: int
    searched: int
    variance: Array
    without: float
    peak: int

    def __str__(self) -> str:
        """A sentence with the evidence."""
        best = int(np.argmin(self.variance))
        least, without = 100.0 * self.variance[best], 100.0 * self.without
        errors = f'{least:.3g} % of the variance of the output, without delay {without:.3g} %'
        return (
            f'delay {self.delay}, searched from 0 to {self.searched}: the error is smallest at {best} '
            f'({errors}); input and '
            f'output correlate most at lag {self.peak}'
        )


def find_delay(y: ArrayLike, u: ArrayLike, longest: int = LONGEST) -> DelaySearch | None:
    """Search the delay of a record.

    Args:
        y: (samples) output; NaN where a sample is missing.
        u: (samples) input; likewise.
        longest: delay to look at, samples; never more than a tenth of the record.

    Returns:
        What was found; None where the record is too short to search.

    Raises:
        SatvibError: a record that is none.
    """
    output, drive = check_record(y, u)
    output, drive = _moving_part(output, drive)
    longest = min(longest, len(output) // 10)
    if longest < 1:
        return None
    everything = slice(None)
    out, late = scale(output, everything).values, scale(drive, everything).values
    columns: list[Column] = [
        ONE, *(('y', i) for i in range(1, POLES + 1)), *(('u', i) for i in range(longest + 3)), ('y', 0),
    ]  # fmt: skip
    rows = np.flatnonzero(known_rows(out, late, columns))
    if len(rows) < 3 * len(columns):
        return find_delay(y, u, longest // 2) if longest > 1 else None
    R = triangle(out, late, columns, rows)
    past, target = list(range(POLES + 1)), len(columns) - 1
    losses = []
    for delay in range(longest + 1):
        given = [*past, POLES + 1 + delay, POLES + 2 + delay]
        losses.append(regress(R, target, given, len(rows)).variance)
    without = regress(R, target, [*past, POLES + 1, POLES + 2, POLES + 3], len(rows)).variance
    power = float(np.nanvar(out))
    variance = np.maximum(np.array(losses) / power, ROUNDING)
    without = max(without / power, ROUNDING)
    best = int(np.argmin(variance))
    ratio = without / variance[best]
    taken = best if ratio > GAIN and len(rows) * np.log(ratio) > SURE else 0
    known = np.isfinite(out) & np.isfinite(late)
    cross = correlation(centred(out, known), centred(late, known), longest)
    return DelaySearch(taken, longest, variance, without, int(np.argmax(np.abs(cross))))


def _moving_part(y: Array, u: Array) -> tuple[Array, Array]:
    """The first samples from which the input moves on, no more than are looked at."""
    known = np.flatnonzero(np.isfinite(u))
    moved = np.flatnonzero(u[known] != u[known[0]])
    start = max(int(known[moved[0]]) - 10, 0) if moved.size else 0
    if len(u) - start < ROWS // 4:
        start = 0
    part = slice(start, start + ROWS)
    if np.isfinite(y[part]).sum() < 20 or np.nanvar(y[part]) == 0.0 or np.nanvar(u[part]) == 0.0:
        part = slice(None, 10 * ROWS)
    return y[part], u[part]
