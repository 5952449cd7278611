# SPDX-FileCopyrightText: 2026 The satvib authors
# SPDX-License-Identifier: Apache-2.0
"""Whether the model of a record may be trusted, found from the record itself.

One small triangle holds both signals at the lags around a sample. Regressions in it answer: does the output help to
predict the input (then a controller was running, or the columns are swapped); is the input an exact combination of the
output (then the model is that of the controller); does the input help to predict the output at all. The order of
excitation is that of the node (`trust.measures`): what is left of each delayed copy of the input after those before
it, here compared with the noise. What the residual still owes to the input is found as in `trust.model_error`, over
all lags that the record allows.

T. Soederstroem and P. Stoica, System Identification, 1989, chapter 10 (closed loops); C. W. J. Granger, Econometrica
37, 1969 (whether one signal helps to predict another).
"""

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from satvib_common.arrays import Array
from scipy.linalg import LinAlgError, solve_toeplitz

from satvib_ident.offline.compressed import ONE, Column, known_rows, regress, triangle, upper
from satvib_ident.offline.delay import find_delay
from satvib_ident.offline.fits import Fitted, follow
from satvib_ident.offline.residuals import NINETY_NINE, centred, correlation
from satvib_ident.offline.result import Candidate, Finding, Found
from satvib_ident.offline.variants import LeastSquares

ROWS = 50_000  # samples that are looked at
LAGS = 10  # of each signal in the regressions
MEMORY = 300  # lags at which the residual is looked for in the input
EXACT = 1e-8  # share of power: 0.01 % of the signal
ROUNDED = 10.0  # times the power of rounding
SURE = 30.0  # N ln(ratio of variances): far beyond chance
HELPS = 0.9  # ratio of variances; less is what a weak coupling of the sensors gives
FEW_LEVELS = 20  # a signal with no more values was made by a generator
UNPREDICTABLE = (
    0.9  # share of the input that its own past does not explain: white, made by a generator
)
FLAT = 2.2  # kurtosis below which a signal has the envelope of a chirp or of uniform numbers
REST = 1e-24  # share of power left of a copy: rounding (`trust.measures`)
REST_CAP = 1e-6
ANSWER = 0.3  # error of the response, as `trust_error` of the node
HINT = 0.1
RIDGE = 1e-3
STEP_LOSS = 0.7  # an unstable model must err this much less than a stable one to be named
SWAP = 0.4  # of fit
SWAP_SHARE, SWAP_OTHER = 0.8, 0.2  # of what the own past of a signal leaves open
PERFECT = 1e-12  # share of the output's power left by a model


@dataclass(frozen=True, eq=False)
class _Around:
    """Regressions on both signals around a sample."""

    columns: list[Column]
    R: Array
    rows: int

    def left(self, target: Column, given: Sequence[Column]) -> float:
        """Error variance of a regression."""
        at = self.columns.index
        return max(regress(self.R, at(target), [at(c) for c in given], self.rows).variance, 0.0)


def judge(
    candidates: Sequence[Candidate], chosen: Candidate, record: LeastSquares, fitted: Fitted
) -> tuple[Found, ...]:
    """Look at a model and its record.

    Args:
        candidates: all that were compared.
        chosen: the one to judge.
        record: the record in its own units.
        fitted: what the chosen model says of it, in these units.

    Returns:
        What was found, what forbids the model first.
    """
    y, u = record.y.values, record.u.values
    part = slice(None, ROWS)
    around = _look_around(y[part], u[part], chosen)
    excited = _excitation(u, y, fitted, chosen)
    found: list[Found | None] = []
    if around is None:
        found += [_excitation_found(excited, chosen)]
    else:
        feedback = _pure_feedback(around, y[part], u[part])
        found += [feedback or _excitation_found(excited, chosen)]
        if feedback is None:
            found += [_direction(around, y, u, chosen)]
    found += [
        _unstable(candidates, chosen, found),
        _free_run(chosen),
        _residual(y, u, fitted, chosen, record.u.unit / record.y.unit),
        _exact(y, fitted),
    ]
    kept = [f for f in found if f is not None]
    if any(
        f.finding in {Finding.SWAPPED, Finding.PURE_FEEDBACK} for f in kept
    ):  # what else is odd follows from it
        kept = [
            f
            for f in kept
            if not f.finding.trusted or f.finding in {Finding.SWAPPED, Finding.PURE_FEEDBACK}
        ]
        kept = [f for f in kept if f.finding is not Finding.UNSTABLE_IN_LOOP]
    return tuple(sorted(kept, key=lambda f: f.finding.trusted))


def _look_around(y: Array, u: Array, chosen: Candidate) -> _Around | None:
    lags = max(min(LAGS, len(y) // 12), 1)
    late = max(chosen.model.delay - 1, 0)
    columns: list[Column] = [ONE, *(('y', i) for i in range(lags + 1))]
    columns += [('u', i) for i in sorted({*range(lags + 1), *range(late, late + lags + 1)})]
    rows = np.flatnonzero(known_rows(y, u, columns))
    if len(rows) < 3 * len(columns):
        return None
    return _Around(columns, triangle(y, u, columns, rows), len(rows))


def _lags(around: _Around, kind: str, first: int) -> list[Column]:
    return [c for c in around.columns if c[0] == kind and c[1] >= first]


# ---------------------------------------------------------------- the input
def resolution(x: Array) -> float:
    """Power of the rounding of a signal in decimal digits or whole steps; 0 where it has all digits."""
    x = x[np.isfinite(x)][:2000]
    values = np.unique(x)
    if len(values) <= FEW_LEVELS:  # made so
        return 0.0
    step = np.diff(values)
    step = step[step > 1e-12 * np.max(np.abs(x))] if len(step) else step
    if not len(step):
        return 0.0
    smallest = float(step.min())
    # all differences are multiples of a rounding step, up to the noise of floating-point numbers
    off = np.abs(step / smallest - np.rint(step / smallest))
    return smallest**2 / 12.0 if float(np.max(off)) < 0.05 else 0.0


def _excitation(u: Array, y: Array, fitted: Fitted, chosen: Candidate) -> int:
    """Order up to which the input excites, above rounding and above the noise of the model."""
    count = chosen.parameters
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
    floor = max(REST * power, min(ROUNDED * 10.0 * resolution(part), REST_CAP * power))
    # a coefficient that noise leaves open by as much as the whole gain is not known
    open_by_noise = noise / (np.isfinite(u).sum() * np.maximum(left, 1e-300)) > gain
    poor = (left <= floor) | open_by_noise
    return int(np.argmax(poor)) if poor.any() else count


def _excitation_found(excited: int, chosen: Candidate) -> Found | None:
    if excited >= chosen.parameters:
        return None
    return Found(
        Finding.POOR_EXCITATION,
        f'the input excites only order {excited} above the noise, the {chosen.parameters} parameters of '
        f'{chosen.name} need '
        f'{chosen.parameters}, so others fit as well',
    )


def _pure_feedback(around: _Around, y: Array, u: Array) -> Found | None:
    """The input as an exact combination of the output: then the model is that of the controller."""
    power = around.left(('u', 0), [ONE])
    if not power > 0.0:
        return None
    own = around.left(('u', 0), [ONE, *_lags(around, 'u', 1)])
    before = around.left(('u', 0), [ONE, *_lags(around, 'u', 1), *_lags(around, 'y', 1)])
    now = around.left(('u', 0), [ONE, *_lags(around, 'u', 1), *_lags(around, 'y', 0)])
    gain = power / (around.left(('y', 0), [ONE]) or 1.0)
    limit = max(EXACT * power, ROUNDED * (resolution(u) + gain * resolution(y)))
    limit = min(limit, 1e-6 * power)
    if own < 100.0 * limit:  # the input follows from its own past: few sines, not the output
        return None
    if before < limit and _generated(
        y, around.left(('y', 0), [ONE, *_lags(around, 'y', 1)]) * gain / power
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


def _rank(around: _Around, limit: float) -> str:
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


# ---------------------------------------------------------------- both directions
def _direction(around: _Around, y: Array, u: Array, chosen: Candidate) -> Found | None:
    """Which signal helps to predict which."""
    own_u = around.left(('u', 0), [ONE, *_lags(around, 'u', 1)])
    with_y = around.left(('u', 0), [ONE, *_lags(around, 'u', 1), *_lags(around, 'y', 1)])
    own_y = around.left(('y', 0), [ONE, *_lags(around, 'y', 1)])
    late = chosen.model.delay - 1 if chosen.model.delay else 0
    with_u = around.left(('y', 0), [ONE, *_lags(around, 'y', 1), *_lags(around, 'u', max(late, 0))])
    power = around.left(('u', 0), [ONE])
    answers = (
        own_u > 1e-6 * power
        and with_y < HELPS * own_u
        and around.rows * math.log(own_u / max(with_y, 1e-300)) > SURE
    )
    explains = own_y > 0.0 and around.rows * math.log(own_y / max(with_u, 1e-300)) > SURE
    share = 1.0 - with_y / own_u if own_u > 0.0 else 0.0
    gained = f'the past of the output explains {100.0 * share:.0f} % of what the past of the input leaves open'
    past_u = around.left(('y', 0), [ONE, *_lags(around, 'y', 1), *_lags(around, 'u', 1)])
    other = 1.0 - past_u / own_y if own_y > 0.0 else 0.0
    if (
        (answers and not explains)
        or (answers and share > SWAP_SHARE and other < SWAP_OTHER)
        or _reverse_is_better(around, y, u, chosen)
        or (not explains and (back := find_delay(u, y)) is not None and back.delay > 0)
    ):
        return Found(
            Finding.SWAPPED,
            f'{gained}, the other way round it is {100.0 * max(other, 0.0):.0f} %: the input looks like the answer',
        )
    if not explains:
        reach = chosen.model.delay + LAGS
        return Found(
            Finding.NO_RESPONSE, f'the input explains nothing of the output within {reach} samples'
        )
    if answers:
        return Found(
            Finding.FEEDBACK,
            f'the input answers to the output ({gained}): a controller was running',
        )
    return None


def _reverse_is_better(around: _Around, y: Array, u: Array, chosen: Candidate) -> bool:
    """Whether a model from output to input runs free much better than the chosen one."""
    if chosen.validation_free_run > 1.0 - SWAP:
        return False
    n = min(max(chosen.model.order, 2), LAGS, max(c[1] for c in around.columns if c[0] == 'y'))
    given: list[Column] = [*(('u', i) for i in range(1, n + 1)), *(('y', i) for i in range(n + 1))]
    at = around.columns.index
    found = regress(around.R, at(('u', 0)), [at(c) for c in [ONE, *given]], around.rows)
    theta = found.theta[1:]
    reverse = follow(-theta[:n], theta[n:], float(found.theta[0]), 0, u, y)
    own = chosen.validation_free_run
    # the past of the output alone must be what explains: else both directions fit, as for a static plant
    return (
        reverse.free_run > 0.5 and reverse.free_run > (own if math.isfinite(own) else -1.0) + SWAP
    )


# ---------------------------------------------------------------- the model
def _unstable(
    candidates: Sequence[Candidate], chosen: Candidate, found: Sequence[Found | None]
) -> Found | None:
    unstable = [c for c in candidates if not bool(c.model.is_stable())]
    if not unstable:
        return None
    best = max(unstable, key=lambda c: c.validation_one_step)
    modulus = float(best.model.pole_modulus())
    loop = any(
        f is not None and f.finding in {Finding.FEEDBACK, Finding.PURE_FEEDBACK} for f in found
    )
    better = 1.0 - best.validation_one_step < STEP_LOSS * (1.0 - chosen.validation_one_step)
    everything = len(unstable) == len(candidates)
    if loop and modulus > 1.0 and (everything or better):
        return Found(
            Finding.UNSTABLE_IN_LOOP,
            f'{best.name} has the best one-step fit, {best.validation_one_step:.4f}, and a pole of modulus '
            f'{modulus:.4f}, '
            'and the input answers to the output: an unstable plant in a loop',
        )
    if everything:
        return Found(
            Finding.ALL_UNSTABLE,
            f'all {len(candidates)} candidates are unstable, the best with a pole of modulus {modulus:.4f}',
        )
    return None


def _free_run(chosen: Candidate) -> Found | None:
    own = chosen.validation_free_run
    if own > 0.0:
        return None
    shown = f'{own:.4f}' if math.isfinite(own) else 'runs away'
    return Found(
        Finding.FREE_RUN_FAILS,
        f'the free-run fit on the validation part is {shown}: the mean of the output is as good as the model',
    )


def _residual(y: Array, u: Array, fitted: Fitted, chosen: Candidate, unit: float) -> Found | None:
    """What the residual still owes to the input, over all lags up to the memory of the record."""
    e = y - fitted.predicted
    known = np.isfinite(e) & np.isfinite(u)
    count = int(known.sum())
    lags = min(MEMORY, count // 10)
    if lags < 2:
        return None
    e, drive = centred(e, known), centred(u, known)
    power_e, power_u = float(e @ e), float(drive @ drive)
    if not (power_e > PERFECT * float(np.nansum(y * y)) and power_u > 0.0):
        return None
    cross = correlation(e, drive, lags)
    own, auto = correlation(drive, drive, lags), correlation(e, e, lags)
    spread = max(1.0 + 2.0 * float((auto[1:] / power_e) @ (own[1:] / power_u)), 1e-3)
    share = cross / math.sqrt(power_e * power_u)
    # 99 % over all lags together: the bound of one lag, for so many
    bound = (NINETY_NINE + math.sqrt(2.0 * math.log(lags + 1))) * math.sqrt(spread / count)
    worst = int(np.argmax(np.abs(share)))
    if abs(share[worst]) <= bound:
        return None
    error = _response_error(own, cross, power_e, chosen.model.b * unit, drive, count)
    evidence = (
        f'the residual still answers to the input, most at lag {worst} (correlation {share[worst]:.2f}, bound '
        f'{bound:.2f}); '
        f'the response is off by about {100.0 * min(error, 99.0):.0f} %'
    )
    reach = chosen.model.delay + chosen.model.b.shape[-1]
    if worst >= reach:
        evidence += f', and the model reaches back {reach} samples only'
    if error >= ANSWER:
        return Found(Finding.RESIDUAL_ANSWERS, evidence)
    return Found(Finding.RESIDUAL_HINT, evidence) if error >= HINT else None


def _response_error(
    own: Array, cross: Array, power_e: float, b: Array, drive: Array, count: int
) -> float:
    """RMS of what a filter of the input explains of the residual, relative to the input's part of the model."""
    row = own.copy()
    row[0] *= 1.0 + RIDGE
    try:
        h = solve_toeplitz(row, cross)
    except (LinAlgError, ValueError):
        return 0.0
    explained = float(h @ cross)
    # what noise alone would explain
    explained -= (power_e - explained) * len(cross) / count
    through = np.convolve(drive, b)[: len(drive)]
    size = float(through @ through)
    return math.sqrt(max(explained, 0.0) / size) if size > 0.0 else math.inf


def _exact(y: Array, fitted: Fitted) -> Found | None:
    e = y - fitted.predicted
    share = float(np.nanmean(e * e)) / (float(np.nanvar(y)) or 1.0)
    if share > PERFECT:
        return None
    return Found(
        Finding.EXACT_FIT,
        f'the model leaves {math.sqrt(share):.1e} of the output, as without any noise',
    )
