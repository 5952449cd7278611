# SPDX-FileCopyrightText: 2026 The satvib authors
# SPDX-License-Identifier: Apache-2.0
"""A model of a whole record: orders compared, the choice explained (`satvib identify`).

Every candidate (n, m, delay) is estimated

* on the first part of the record, and judged on the rest (the validation part) that it has not seen;
* on the whole record, which gives the model itself and, with V the mean square of its one-step errors over N samples,

      AIC = N ln V + 2 p,   BIC = N ln V + p ln N.

Least squares is one triangle for all candidates (`compressed`): what the node's recursion reaches at the last sample.
The other methods are the node's own recursions (`recursion`). Signals are taken in their own units (`scaling`), as they
are, with their means removed, and with a constant term; the variant with the best validation is used.
"""

import math
from collections.abc import Iterable

import numpy as np
from numpy.typing import ArrayLike
from satvib_common.arrays import Array, Mask
from satvib_common.errors import SatvibError

from satvib_ident.estimators.regressor import IirRegressor
from satvib_ident.offline.compressed import Progress, known_rows, quiet
from satvib_ident.offline.residuals import residual_tests
from satvib_ident.offline.result import Candidate, OfflineResult, Offset
from satvib_ident.offline.scaling import check_record
from satvib_ident.offline.variants import LeastSquares, Recursions, Solution, Variants
from satvib_ident.offline.verdicts import judge

METHODS = ('least_squares', 'extended', 'instrumental')
CRITERIA = ('validation', 'bic', 'aic')
TOLERANCE = 0.01  # of fit: a larger model, or another treatment of offsets, must gain more on data it has not seen
ROUNDING = 1e-26  # share of the output's power: errors below it are rounding
ORDERS = tuple((n, n + 1, 0) for n in (1, 2, 3, 4, 6))


def identify(
    y: ArrayLike,
    u: ArrayLike,
    dt: float,
    orders: Iterable[tuple[int, int, int]] = ORDERS,
    method: str = 'least_squares',
    criterion: str = 'validation',
    validation: float = 0.5,
    progress: Progress = quiet,
) -> OfflineResult:
    """Compare orders on a record and choose one.

    Args:
        y: (samples) output, m/s^2; NaN where a sample is missing: nothing is taken across it.
        u: (samples) input, V; likewise.
        dt: s, sample period.
        orders: (poles, coefficients, delay) of each candidate.
        method: least_squares, extended or instrumental.
        criterion: validation (the smallest model whose free-run fit on the validation part is within 0.01 of the
            best), bic or aic.
        validation: share of the record, at its end, that is kept for validation.
        progress: called with the share done and what is being done.

    Raises:
        SatvibError: a record or a setting that cannot be used, by name.
    """
    output, drive = check_record(y, u)
    wanted = _check_settings(orders, method, criterion, validation)
    known = np.cumsum(np.isfinite(output) & np.isfinite(drive))
    count = int(known[-1])
    split = int(np.searchsorted(known, count - round(validation * count))) + 1
    wanted, notes = _possible(output, drive, wanted, split)
    variants = LeastSquares(output, drive, wanted, split, progress)
    offset, said = _choose_offset(variants, wanted)
    notes += said
    used: Variants = variants
    if method != 'least_squares':
        if offset is Offset.CONSTANT:
            offset = Offset.MEANS
        used = Recursions(variants, method, offset, progress)
    rows = known_rows(output, drive, used.columns)
    candidates = []
    for i, order in enumerate(wanted):
        candidates.append(_candidate(used, order, offset, dt, rows))
        progress((i + 1) / len(wanted), 'fits')
    chosen, reason = _choose(candidates, criterion)
    fitted = used.follow(used.solve(_order(chosen), offset, whole=True), slice(None))
    scale, centre = variants.y.unit, variants.y.centre
    predicted, free = centre + scale * fitted.predicted, centre + scale * fitted.free
    tests = residual_tests(output - predicted, drive)
    findings = judge(candidates, chosen, variants, fitted)
    return OfflineResult(
        candidates=tuple(candidates),
        chosen=chosen,
        reason=reason,
        offset=offset,
        notes=tuple(notes),
        findings=findings,
        tests=tests,
        y=output,
        u=drive,
        predicted=predicted,
        free=free,
        split=split,
        method=method,
    )


def _check_settings(
    orders: Iterable[tuple[int, int, int]], method: str, criterion: str, validation: float
) -> list[tuple[int, int, int]]:
    if method not in METHODS:
        raise SatvibError(f'method: {method!r} is not one of {", ".join(METHODS)}')
    if criterion not in CRITERIA:
        raise SatvibError(f'criterion: {criterion!r} is not one of {", ".join(CRITERIA)}')
    if not 0.05 <= validation <= 0.95:
        raise SatvibError(f'validation: {validation} is not between 0.05 and 0.95')
    wanted = list(orders)
    if not wanted:
        raise SatvibError('orders: at least one is needed')
    for n, m, delay in wanted:
        IirRegressor(n, m, delay)  # refuses what is no order
    return wanted


def _possible(
    y: Array, u: Array, wanted: list[tuple[int, int, int]], split: int
) -> tuple[list[tuple[int, int, int]], list[str]]:
    """The orders for which the record has samples enough, and a word on the others."""
    possible, notes = [], []
    for n, m, delay in wanted:
        rows = known_rows(y, u, LeastSquares.columns_of((n, m, delay)))
        if rows[:split].sum() >= 2 * (n + m) and rows[split:].sum() > 2 * max(n, m - 1 + delay):
            possible.append((n, m, delay))
        else:
            notes.append(
                f'too few samples without a gap for {n} poles and {m} coefficients: left out'
            )
    if not possible:
        n, m, delay = min(wanted)
        known = int(np.isfinite(y * 0.0 + u * 0.0).sum())
        complete = int(known_rows(y, u, LeastSquares.columns_of((n, m, delay))).sum())
        late = f' behind {delay} samples' if delay else ''
        raise SatvibError(
            f'record: {known} samples are too few for {n} poles and {m} coefficients{late}, with a part of them for '
            f'validation; without a gap in what they need are {complete}'
        )
    return possible, notes


def _order(candidate: Candidate) -> tuple[int, int, int]:
    return candidate.model.order, candidate.model.b.shape[-1], candidate.model.delay


def _choose_offset(
    variants: LeastSquares, wanted: list[tuple[int, int, int]]
) -> tuple[Offset, list[str]]:
    """Compare what may be done about offsets on the validation part, over all orders.

    As with orders, the smallest model within the tolerance of the best one decides, a constant counts as a parameter,
    and signals stay as measured where that is as good.
    """
    part = slice(variants.split, None)
    trials = []
    for offset in Offset:
        for order in wanted:
            half = variants.solve(order, offset, whole=False)
            fits = variants.follow(half, part)
            stable = half.stable and variants.solve(order, offset, whole=True).stable
            size = order[0] + order[1] + (1 if offset is Offset.CONSTANT else 0)
            trials.append(
                (size, offset, order, fits.free_run if stable else -math.inf, fits.one_step)
            )
    free = max(t[3] for t in trials) > -math.inf
    judged = {t[1:3]: (t[3] if free else t[4]) for t in trials}
    top = max(fit for fit in judged.values() if not math.isnan(fit))
    places = list(Offset)
    size, place, _, order = min(
        (size, places.index(offset), -judged[offset, order], order)
        for size, offset, order, _, _ in trials
        if judged[offset, order] >= top - TOLERANCE
    )
    del size
    if places[place] is Offset.NONE:
        return Offset.NONE, []
    best = max((Offset.MEANS, Offset.CONSTANT), key=lambda o: judged[o, order])
    figures = ', '.join(f'{o.value} {_figure(judged[o, order])}' for o in Offset)
    what = 'free run' if free else 'one step'
    return best, [
        f'offset: {best.value}; {what} of {order[0]}/{order[1]} on the validation part: {figures}'
    ]


def _figure(fit: float) -> str:
    return f'{fit:.4f}' if math.isfinite(fit) else 'runs away'


def _candidate(
    used: Variants, order: tuple[int, int, int], offset: Offset, dt: float, shared: Mask
) -> Candidate:
    half, whole = used.solve(order, offset, whole=False), used.solve(order, offset, whole=True)
    model, deviation, constant = used.in_units(whole, dt)
    fitted = used.follow(whole, slice(None))
    judged = used.follow(half, slice(used.split, None))
    rows = shared & np.isfinite(fitted.predicted)
    if rows.sum() <= 2 * len(whole.theta):  # too many gaps for rows that all candidates share
        rows = np.isfinite(fitted.predicted)
    errors = (used.y.values - fitted.predicted)[rows & np.isfinite(used.y.values)]
    size = len(errors)
    power = max(float(errors @ errors) / size, ROUNDING)
    level = size * (math.log(power) + 2.0 * math.log(used.y.unit))
    count = len(whole.theta)
    return Candidate(
        model=model,
        standard_deviation=deviation,
        noise_variance=whole.variance * used.y.unit**2,
        aic=level + 2.0 * count,
        bic=level + count * math.log(size),
        one_step=fitted.one_step,
        free_run=fitted.free_run,
        validation_one_step=judged.one_step,
        validation_free_run=judged.free_run,
        constant=constant,
    )


def _choose(candidates: list[Candidate], criterion: str) -> tuple[Candidate, str]:
    if len(candidates) == 1:
        return candidates[0], 'the only order asked for'
    best, reason = _best(candidates, criterion)
    sizes = [c.parameters for c in candidates]
    if best.parameters == max(sizes) > min(sizes):
        reason += '; it is the largest compared, a larger one may be better'
    return best, reason


def _best(candidates: list[Candidate], criterion: str) -> tuple[Candidate, str]:
    stable = [c for c in candidates if bool(c.model.is_stable())]
    aside = (
        f'; {len(candidates) - len(stable)} unstable set aside'
        if len(stable) < len(candidates)
        else ''
    )
    pool = stable or candidates
    if criterion == 'bic':
        best = min(pool, key=lambda c: c.bic)
        return best, f'{best.name} has the smallest BIC, {best.bic:.1f}{aside}'
    if criterion == 'aic':
        best = min(pool, key=lambda c: c.aic)
        return best, f'{best.name} has the smallest AIC, {best.aic:.1f}{aside}'
    if not stable:
        best = max(pool, key=lambda c: c.validation_one_step)
        return best, (
            f'{best.name} has the best one-step fit on the validation part, {best.validation_one_step:.4f}; '
            'none is stable'
        )
    top = max(pool, key=lambda c: c.validation_free_run)
    close = [c for c in pool if c.validation_free_run >= top.validation_free_run - TOLERANCE]
    best = min(close, key=lambda c: (c.parameters, -c.validation_free_run))
    if best is top:
        why = 'has the best free-run fit on the validation part'
    else:
        why = (
            f'is the smallest within {TOLERANCE:g} of the best free-run fit on the validation part '
            f'({top.validation_free_run:.4f} of {top.name}): its own'
        )
    return best, f'{best.name} {why}, {best.validation_free_run:.4f}{aside}'


__all__ = ['CRITERIA', 'METHODS', 'ORDERS', 'Solution', 'identify']
