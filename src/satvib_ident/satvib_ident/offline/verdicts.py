# SPDX-FileCopyrightText: 2026 The satvib authors
# SPDX-License-Identifier: Apache-2.0
"""Whether the model of a record may be trusted, found from the record itself.

One small triangle holds both signals at the lags around a sample. Regressions in it answer: does the output help to
predict the input (then a controller was running, or the columns are swapped); does the input help to predict the output
at all. What the residual still owes to the input is found as in `trust.model_error`, over all lags that the record
allows. Whether the input can tell a model is in `input_findings`.

T. Soederstroem and P. Stoica, System Identification, 1989, chapter 10 (closed loops); C. W. J. Granger, Econometrica
37, 1969 (whether one signal helps to predict another).
"""

import math
from collections.abc import Sequence

import numpy as np
from satvib_common.arrays import Array
from scipy.linalg import LinAlgError, solve_toeplitz

from satvib_ident.offline.compressed import ONE, Column, regress
from satvib_ident.offline.delay import find_delay
from satvib_ident.offline.fits import Fitted, follow
from satvib_ident.offline.input_findings import (
    LAGS,
    ROWS,
    Around,
    excitation_found,
    excitation_order,
    lags_of,
    look_around,
    pure_feedback,
)
from satvib_ident.offline.residuals import NINETY_NINE, centred, correlation
from satvib_ident.offline.result import Candidate, Finding, Found
from satvib_ident.offline.variants import LeastSquares

MEMORY = 300  # lags at which the residual is looked for in the input
SURE = 30.0  # N ln(ratio of variances): far beyond chance
HELPS = 0.9  # ratio of variances; less is what a weak coupling of the sensors gives
ANSWER = 0.3  # error of the response, as `trust_error` of the node
HINT = 0.1
RIDGE = 1e-3
STEP_LOSS = 0.7  # an unstable model must err this much less than a stable one to be named
SWAP = 0.4  # of fit
SWAP_SHARE, SWAP_OTHER = 0.8, 0.2  # of what the own past of a signal leaves open
FAR = 8.0  # robust deviations of the error
MOST = 0.5  # of its power
FEW = 0.01  # of the samples
PERFECT = 1e-12  # share of the output's power left by a model


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
    around = look_around(y[part], u[part], chosen.model.delay)
    excited = excitation_order(record.u, y, fitted, chosen)
    found: list[Found | None] = []
    if around is None:
        found += [excitation_found(excited, chosen)]
    else:
        feedback = pure_feedback(around, record)
        found += [feedback or excitation_found(excited, chosen)]
        if feedback is None:
            found += [_direction(around, y, u, fitted, chosen)]
    found += [
        _unstable(candidates, chosen, around is not None and _answers(around)),
        _free_run(chosen),
        _residual(y, u, fitted, chosen, record.u.unit / record.y.unit),
        _few_samples(y, fitted),
        _exact(y, fitted),
    ]
    kept = [f for f in found if f is not None]
    # what else is odd follows from these
    if any(f.finding in {Finding.SWAPPED, Finding.PURE_FEEDBACK} for f in kept):
        kept = [
            f
            for f in kept
            if not f.finding.trusted or f.finding in {Finding.SWAPPED, Finding.PURE_FEEDBACK}
        ]
        kept = [f for f in kept if f.finding is not Finding.UNSTABLE_IN_LOOP]
    return tuple(sorted(kept, key=lambda f: f.finding.trusted))


# ---------------------------------------------------------------- both directions
def _answers(around: Around, newest: int = 1) -> bool:
    """Whether the other signal, from lag `newest` on, helps to predict the input."""
    own = around.left(('u', 0), [ONE, *lags_of(around, 'u', 1)])
    other = around.left(('u', 0), [ONE, *lags_of(around, 'u', 1), *lags_of(around, 'y', newest)])
    if not own > 1e-6 * around.left(('u', 0), [ONE]):  # few sines follow from themselves
        return False
    return other < HELPS * own and around.rows * math.log(own / max(other, 1e-300)) > SURE


def _direction(
    around: Around, y: Array, u: Array, fitted: Fitted, chosen: Candidate
) -> Found | None:
    """Which signal helps to predict which."""
    own_u = around.left(('u', 0), [ONE, *lags_of(around, 'u', 1)])
    with_y = around.left(('u', 0), [ONE, *lags_of(around, 'u', 1), *lags_of(around, 'y', 1)])
    own_y = around.left(('y', 0), [ONE, *lags_of(around, 'y', 1)])
    late = chosen.model.delay - 1 if chosen.model.delay else 0
    with_u = around.left(
        ('y', 0), [ONE, *lags_of(around, 'y', 1), *lags_of(around, 'u', max(late, 0))]
    )
    answers = _answers(around)
    explains = own_y > 0.0 and around.rows * math.log(own_y / max(with_u, 1e-300)) > SURE
    share = 1.0 - with_y / own_u if own_u > 0.0 else 0.0
    gained = f'the past of the output explains {100.0 * share:.0f} % of what the past of the input leaves open'
    past_u = around.left(('y', 0), [ONE, *lags_of(around, 'y', 1), *lags_of(around, 'u', 1)])
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
    return _feedback(y, u, fitted, newest=0 if chosen.model.delay else 1)


def _feedback(y: Array, u: Array, fitted: Fitted, newest: int) -> Found | None:
    """Whether the input answers to what the model does not explain of the output, as it does under a controller."""
    error = (y - fitted.predicted)[:ROWS]
    if not float(np.nanmean(error**2)) > PERFECT * float(np.nanvar(y)):
        return None
    around = look_around(error, u[:ROWS], 0)
    if around is None:
        return None
    if not _answers(around, newest):
        return None
    own = around.left(('u', 0), [ONE, *lags_of(around, 'u', 1)])
    with_error = around.left(
        ('u', 0), [ONE, *lags_of(around, 'u', 1), *lags_of(around, 'y', newest)]
    )
    share = 100.0 * (1.0 - with_error / own)
    return Found(
        Finding.FEEDBACK,
        f'the input answers to the error of the model, which explains {share:.0f} % of what the past of the input '
        'leaves open: a controller was running, or the '
        'input that was measured is part of the answer',
    )


def _reverse_is_better(around: Around, y: Array, u: Array, chosen: Candidate) -> bool:
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
def _unstable(candidates: Sequence[Candidate], chosen: Candidate, loop: bool) -> Found | None:
    unstable = [c for c in candidates if not bool(c.model.is_stable())]
    if not unstable:
        return None
    best = max(unstable, key=lambda c: c.validation_one_step)
    modulus = float(best.model.pole_modulus())
    better = 1.0 - best.validation_one_step < STEP_LOSS * (1.0 - chosen.validation_one_step)
    everything = len(unstable) == len(candidates)
    if loop and modulus > 1.0 and (everything or better):
        return Found(
            Finding.UNSTABLE_IN_LOOP,
            f'{best.name} has the best one-step fit, {best.validation_one_step:.4f}, and a pole of modulus '
            f'{modulus:.4f}, and the input answers to the output: an unstable plant in a loop',
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
    lags = min(MEMORY, count // 4)
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


def _few_samples(y: Array, fitted: Fitted) -> Found | None:
    """Whether a few samples hold most of the error, as wrong ones do: least squares then fits those."""
    error = y - fitted.predicted
    e = np.where(np.isfinite(error), error, 0.0)
    power = float(e @ e)
    usual = 1.4826 * float(np.nanmedian(np.abs(error)))
    far = np.abs(e) > FAR * usual
    share = float(e[far] @ e[far]) / (power or 1.0)
    if not (
        usual > 0.0
        and share > MOST
        and far.sum() <= FEW * len(e) + 3
        and power > PERFECT * float(np.nansum(y * y))
    ):
        return None
    return Found(
        Finding.FEW_SAMPLES,
        f'{int(far.sum())} samples, the first at {int(np.argmax(far))}, hold {100.0 * share:.0f} % of the power of the '
        'error: they are wrong, or something else happened there',
    )


def _exact(y: Array, fitted: Fitted) -> Found | None:
    e = y - fitted.predicted
    share = float(np.nanmean(e * e)) / (float(np.nanvar(y)) or 1.0)
    if share > PERFECT:
        return None
    return Found(
        Finding.EXACT_FIT,
        f'the model leaves {math.sqrt(share):.1e} of the output, as without any noise',
    )
