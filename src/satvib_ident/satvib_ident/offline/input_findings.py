# SPDX-FileCopyrightText: 2026 The satvib authors
# SPDX-License-Identifier: Apache-2.0
"""Whether the input of a record can tell a model at all: its order of excitation, and whether it is pure feedback.

The order of excitation is that of the node (`trust.measures`): what is left of each delayed copy of the input after
those before it, here compared with the rounding of the record and with the noise. An input that is an exact combination
of the output comes from a controller without excitation; the model is then that of the controller.

T. Soederstroem and P. Stoica, System Identification, 1989, chapters 5 (excitation) and 10 (closed loops).
"""

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from satvib_common.arrays import Array

from satvib_ident.offline.compressed import ONE, Column, known_rows, regress, triangle, upper
from satvib_ident.offline.fits import Fitted
from satvib_ident.offline.result import Candidate, Finding, Found
from satvib_ident.offline.scaling import Scaled
from satvib_ident.offline.variants import LeastSquares

ROWS = 50_000  # samples that are looked at
LAGS = 10  # of each signal in the regressions
EXACT = 1e-8  # share of power: 0.01 % of the signal
ROUNDED = 10.0  # times the power of rounding
EXACT_CAP = 1e-6  # share of power that rounding may make of that
FEW_LEVELS = 20  # a signal with no more values was made by a generator
UNPREDICTABLE = (
    0.9  # share of a signal that its own past does not explain: white, made by a generator
)
FLAT = 2.2  # kurtosis below which a signal has the envelope of a chirp or of uniform numbers
REST = 1e-14  # share of power left of a copy that rounding to eight digits may leave
REST_CAP = 1e-6  # the most that is taken for rounding
DIGITS = 9  # decimal digits that are looked for


@dataclass(frozen=True, eq=False)
class Around:
    """Regressions on both signals around a sample."""

    columns: list[Column]
    R: Array
    rows: int

    def left(self, target: Column, given: Sequence[Column]) -> float:
        """Error variance of a regression."""
        at = self.columns.index
        return max(regress(self.R, at(target), [at(c) for c in given], self.rows).variance, 0.0)


def look_around(y: Array, u: Array, delay: int) -> Around | None:
    """The triangle of both signals around a sample; None where the record is too short."""
    lags = max(min(LAGS, len(y) // 12), 1)
    late = max(delay - 1, 0)
    columns: list[Column] = [ONE, *(('y', i) for i in range(lags + 1))]
    columns += [('u', i) for i in sorted({*range(lags + 1), *range(late, late + lags + 1)})]
    rows = np.flatnonzero(known_rows(y, u, columns))
    if len(rows) < 3 * len(columns):
        return None
    return Around(columns, triangle(y, u, columns, rows), len(rows))


def lags_of(around: Around, kind: str, first: int) -> list[Column]:
    """Columns of one signal from a lag on."""
    return [c for c in around.columns if c[0] == kind and c[1] >= first]


def resolution(signal: Scaled) -> float:
    """Power of the rounding of a signal to decimal digits or to a converter's steps, in its own unit; 0 for none."""
    x = signal.values[np.isfinite(signal.values)][:2000]
    raw = signal.centre + signal.unit * x
    size = float(np.max(np.abs(raw))) if len(raw) else 0.0
    if not 1e-290 < size < 1e290:
        return 0.0
    for digits in range(DIGITS):
        step = 10.0 ** (math.ceil(math.log10(size)) - digits)
        if np.max(np.abs(raw / step - np.rint(raw / step))) < 1e-4:
            return (step / signal.unit) ** 2 / 12.0
    steps = np.diff(np.unique(x))
    smallest = float(steps.min()) if len(steps) else 0.0
    if smallest > 1e-6 and np.max(np.abs(steps / smallest - np.rint(steps / smallest))) < 0.01:
        return smallest**2 / 12.0
    return 0.0


def excitation_order(signal: Scaled, y: Array, fitted: Fitted, chosen: Candidate) -> int:
    """Order up to which the input excites, above rounding and above the noise of the model."""
    count = chosen.parameters
    u = signal.values
    part = u[:ROWS]
    columns: list[Column] = [ONE, *(('u', i) for i in range(count))]
    rows = np.flatnonzero(known_rows(part, part, columns))
    if len(rows) < 2 * count:
        return count
    left = np.diag(triangle(part, part, columns, rows))[1:] ** 2 / len(rows)
    power = float(np.nanvar(part)) or 1.0
    error = y - fitted.predicted
    noise = float(np.nanmean(error**2))
    gain = float(np.nanvar(y)) / power
    floor = max(REST * power, min(ROUNDED * 10.0 * resolution(signal), REST_CAP * power))
    # a coefficient that noise leaves open by as much as the whole gain is not known
    open_by_noise = noise / (np.isfinite(u).sum() * np.maximum(left, 1e-300)) > gain
    poor = (left <= floor) | open_by_noise
    return int(np.argmax(poor)) if poor.any() else count


def excitation_found(excited: int, chosen: Candidate) -> Found | None:
    """What follows from an order of excitation."""
    if excited >= chosen.parameters:
        return None
    return Found(
        Finding.POOR_EXCITATION,
        f'the input excites only order {excited} above the noise, the {chosen.parameters} parameters of '
        f'{chosen.name} need '
        f'{chosen.parameters}, so others fit as well',
    )


def pure_feedback(around: Around, record: LeastSquares) -> Found | None:
    """The input as an exact combination of the output: then the model is that of the controller."""
    power = around.left(('u', 0), [ONE])
    if not power > 0.0:
        return None
    y, u = record.y.values[:ROWS], record.u.values[:ROWS]
    own = around.left(('u', 0), [ONE, *lags_of(around, 'u', 1)])
    before = around.left(('u', 0), [ONE, *lags_of(around, 'u', 1), *lags_of(around, 'y', 1)])
    now = around.left(('u', 0), [ONE, *lags_of(around, 'u', 1), *lags_of(around, 'y', 0)])
    gain = power / (around.left(('y', 0), [ONE]) or 1.0)
    limit = max(EXACT * power, ROUNDED * (resolution(record.u) + gain * resolution(record.y)))
    limit = min(limit, EXACT_CAP * power)
    if own < 100.0 * limit:  # the input follows from its own past: few sines, not the output
        return None
    if before < limit and _generated(
        y, around.left(('y', 0), [ONE, *lags_of(around, 'y', 1)]) * gain / power
    ):
        return Found(
            Finding.SWAPPED,
            'the input follows from the past of the output (what is left of it is '
            f'{math.sqrt(before / power):.1e} of its '
            'deviation), and the output looks made by a generator',
        )
    rank = _rank(around, limit)
    what = (
        f'the input is an exact combination of the output (what is left of it is {math.sqrt(now / power):.1e} of its '
        f'deviation; {rank}), as under a controller without excitation: the model is that of the controller, '
        'and nothing '
        'follows about the plant'
    )
    if before < limit:
        return Found(Finding.PURE_FEEDBACK, what)
    if now < limit and not _generated(u, own / power):
        return Found(Finding.PURE_FEEDBACK, what)
    return None


def _rank(around: Around, limit: float) -> str:
    """Rank of a regressor of two past outputs and three inputs at the scale of the noise."""
    wanted: list[Column] = [('y', 1), ('y', 2), ('u', 0), ('u', 1), ('u', 2)]
    present = [around.columns.index(c) for c in [ONE, *wanted] if c in around.columns]
    small = upper(around.R[:, present])
    s = np.linalg.svd(small[1:, 1:], compute_uv=False)
    rank = int(np.sum(s**2 / around.rows > 4.0 * limit))
    return f'the regressor of order 2 has rank {rank} of {len(present) - 1}'


def _generated(u: Array, unpredictable: float) -> bool:
    """Whether a signal looks made by a generator: few values, white, or of a flat envelope."""
    x = u[np.isfinite(u)]
    x = x - x.mean()
    kurtosis = float(np.mean(x**4) / (np.mean(x**2) ** 2 or 1.0))
    return len(np.unique(x)) <= FEW_LEVELS or unpredictable > UNPREDICTABLE or kurtosis < FLAT
