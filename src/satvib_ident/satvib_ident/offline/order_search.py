# SPDX-FileCopyrightText: 2026 The satvib authors
# SPDX-License-Identifier: Apache-2.0
"""A model of a whole record: orders compared, the choice explained (`satvib identify`).

Every candidate (n, m, delay) is estimated by the same recursive estimators as in the node,

* on the first part of the record, and judged on the rest (the validation part) that it has not seen;
* on the whole record, which gives the model itself and, with V the mean square of its one-step errors over N samples,

      AIC = N ln V + 2 p,   BIC = N ln V + p ln N.

Fits are 1 - |y - yhat| / |y - mean y|: of one-step predictions, and of a free run from the measured start.
"""

import math
from collections.abc import Iterable
from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike
from satvib_common.arrays import Array
from satvib_common.errors import SatvibError

from satvib_ident.estimators.extended import ExtendedLeastSquares
from satvib_ident.estimators.instrumental import InstrumentalVariable
from satvib_ident.estimators.least_squares import RecursiveLeastSquares
from satvib_ident.estimators.regressor import IirRegressor
from satvib_ident.models.iir_model import IirModel
from satvib_ident.offline.residuals import ResidualTests, residual_tests

METHODS = ('least_squares', 'extended', 'instrumental')
CRITERIA = ('validation', 'bic', 'aic')
TOLERANCE = 0.01  # of fit: a larger model must gain more than this on data it has not seen


@dataclass(frozen=True, eq=False)
class Candidate:
    """One order and what it achieves.

    Attributes:
        model: estimated on the whole record.
        standard_deviation: (p) of a, b.
        noise_variance: of the one-step errors.
        aic, bic: information criteria over the samples that all candidates share.
        one_step, free_run: fits over the whole record.
        validation_one_step, validation_free_run: fits over the validation part of the model of the first part.
    """

    model: IirModel
    standard_deviation: Array
    noise_variance: float
    aic: float
    bic: float
    one_step: float
    free_run: float
    validation_one_step: float
    validation_free_run: float

    @property
    def parameters(self) -> int:
        """Number of parameters, n + m."""
        return self.model.theta.shape[-1]

    @property
    def name(self) -> str:
        """'n/m' and the delay where there is one."""
        late = f', delay {self.model.delay}' if self.model.delay else ''
        return f'{self.model.order}/{self.model.b.shape[-1]}{late}'


@dataclass(frozen=True, eq=False)
class OfflineResult:
    """What `identify` found.

    Attributes:
        candidates: in the order asked for.
        chosen: the one that `reason` speaks of.
        reason: why it was chosen, a sentence.
        tests: correlations of its residual over the whole record.
        y, u: the record as used, (samples).
        residual: one-step errors of the chosen model, (samples); NaN where there are none yet.
        split: first sample of the validation part.
        method: how it was estimated.
    """

    candidates: tuple[Candidate, ...]
    chosen: Candidate
    reason: str
    tests: ResidualTests
    y: Array
    u: Array
    residual: Array
    split: int
    method: str

    @property
    def model(self) -> IirModel:
        """The chosen model."""
        return self.chosen.model

    def about(self) -> dict[str, float | int | str]:
        """Plain data for the model's file."""
        return {
            'method': self.method,
            'samples': len(self.y),
            'chosen because': self.reason,
            'one-step fit': self.chosen.one_step,
            'free-run fit': self.chosen.free_run,
            'noise variance': self.chosen.noise_variance,
        }


def check_record(y: ArrayLike, u: ArrayLike) -> tuple[Array, Array]:
    """Give a record as two arrays of floats.

    Raises:
        SatvibError: not numbers, of different lengths, with values that are not finite, or an input that never moves.
    """
    try:
        out, drive = np.asarray(y, dtype=float), np.asarray(u, dtype=float)
    except (TypeError, ValueError) as error:
        raise SatvibError(f'record: not numbers: {error}') from None
    if out.ndim != 1 or out.shape != drive.shape:
        raise SatvibError(f'record: output {out.shape} and input {drive.shape} differ in shape')
    for name, values in (('output', out), ('input', drive)):
        bad = np.flatnonzero(~np.isfinite(values))
        if bad.size:
            raise SatvibError(
                f'record: {name}: sample {bad[0]} is {values[bad[0]]}, as are {bad.size - 1} more; '
                'cut or repair the record'
            )
        if np.ptp(values) == 0.0:
            raise SatvibError(f'record: {name}: never changes, so nothing can be told from it')
    return out, drive


def estimate(
    y: Array, u: Array, poles: int, coefficients: int, delay: int, method: str = 'least_squares'
) -> RecursiveLeastSquares:
    """Run a recursive estimator over a record (samples) and give it back.

    Args:
        y: (samples) output.
        u: (samples) input.
        poles: n.
        coefficients: m.
        delay: samples.
        method: one of METHODS.

    Raises:
        SatvibError: too few samples, or an unknown method.
    """
    count = poles + coefficients
    regressor = IirRegressor(poles, coefficients, delay)
    first = max(poles, coefficients - 1 + delay)
    if len(y) - first < 2 * count:
        raise SatvibError(
            f'record: {len(y)} samples are too few for {poles} poles and {coefficients} coefficients'
        )
    estimator: RecursiveLeastSquares
    if method == 'least_squares':
        estimator = RecursiveLeastSquares(count)
    elif method == 'extended':
        estimator = ExtendedLeastSquares(count, poles)
    elif method == 'instrumental':
        estimator = InstrumentalVariable(poles, coefficients)
    else:
        raise SatvibError(f'method: {method!r} is not one of {", ".join(METHODS)}')
    unknown = np.asarray(np.nan)
    for k in range(len(y)):
        late = np.asarray(u[k - delay]) if k >= delay else unknown
        w, target, full = regressor.step(np.asarray(y[k]), late, 0.0)
        if not full:
            estimator.interrupt()
        estimator.update(w, target, full)
    return estimator


def _fit(y: Array, modelled: Array) -> float:
    """Fit of a record; -inf where the model has run away."""
    spread = float(np.linalg.norm(y - y.mean()))
    if not spread > 0.0 or not float(np.max(np.abs(modelled))) < 1e6 * spread:
        return -math.inf
    return 1.0 - float(np.linalg.norm(y - modelled)) / spread


def _fits(model: IirModel, y: Array, u: Array) -> tuple[float, float]:
    """One-step and free-run fit over a record, without the samples that start it."""
    first = max(model.order, model.b.shape[-1] - 1 + model.delay)
    with np.errstate(over='ignore', invalid='ignore'):
        free = model.simulate(u, y[:first])
    return _fit(y[first:], model.predict(y, u)[first:]), _fit(y[first:], free[first:])


def _candidate(
    y: Array, u: Array, dt: float, order: tuple[int, int, int], method: str, split: int, common: int
) -> Candidate:
    n, m, delay = order
    count = n + m

    def model_of(estimator: RecursiveLeastSquares) -> IirModel:
        return IirModel(estimator.theta[:n], estimator.theta[n:count], delay, dt)

    whole = estimate(y, u, n, m, delay, method)
    model = model_of(whole)
    half = model_of(estimate(y[:split], u[:split], n, m, delay, method))
    errors = (y - model.predict(y, u))[common:]
    size = len(errors)
    level = size * math.log(max(float(errors @ errors) / size, 1e-300))
    one_step, free_run = _fits(model, y, u)
    validation_one_step, validation_free_run = _fits(half, y[split:], u[split:])
    return Candidate(
        model=model,
        standard_deviation=np.sqrt(np.diagonal(whole.covariance)[:count]),
        noise_variance=float(whole.noise_variance),
        aic=level + 2.0 * count,
        bic=level + count * math.log(size),
        one_step=one_step,
        free_run=free_run,
        validation_one_step=validation_one_step,
        validation_free_run=validation_free_run,
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


def identify(
    y: ArrayLike,
    u: ArrayLike,
    dt: float,
    orders: Iterable[tuple[int, int, int]] = (
        (1, 2, 0),
        (2, 3, 0),
        (3, 4, 0),
        (4, 5, 0),
        (6, 7, 0),
    ),
    method: str = 'least_squares',
    criterion: str = 'validation',
    validation: float = 0.5,
) -> OfflineResult:
    """Compare orders on a record and choose one.

    Args:
        y: (samples) output, m/s^2.
        u: (samples) input, V.
        dt: s, sample period.
        orders: (poles, coefficients, delay) of each candidate.
        method: least_squares, extended or instrumental.
        criterion: validation (the smallest model whose free-run fit on the validation part is within 0.01 of the
        best),
            bic or aic.
        validation: share of the record, at its end, that is kept for validation.

    Raises:
        SatvibError: a record or a setting that cannot be used, by name.
    """
    output, drive = check_record(y, u)
    if criterion not in CRITERIA:
        raise SatvibError(f'criterion: {criterion!r} is not one of {", ".join(CRITERIA)}')
    if not 0.05 <= validation <= 0.95:
        raise SatvibError(f'validation: {validation} is not between 0.05 and 0.95')
    wanted = list(orders)
    if not wanted:
        raise SatvibError('orders: at least one is needed')
    split = len(output) - round(validation * len(output))
    common = max(max(n, m - 1 + delay) for n, m, delay in wanted)
    if len(output) - split <= 2 * common:
        raise SatvibError(
            f'record: {len(output) - split} samples are too few to validate {max(wanted)[0]} poles'
        )
    candidates = [_candidate(output, drive, dt, o, method, split, common) for o in wanted]
    chosen, reason = _choose(candidates, criterion)
    model = chosen.model
    first = max(model.order, model.b.shape[-1] - 1 + model.delay)
    residual = output - model.predict(output, drive)
    residual[:first] = np.nan
    tests = residual_tests(residual[first:], drive[first:])
    return OfflineResult(
        tuple(candidates), chosen, reason, tests, output, drive, residual, split, method
    )
