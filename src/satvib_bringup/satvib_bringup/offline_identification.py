# SPDX-FileCopyrightText: 2026 The satvib authors
# SPDX-License-Identifier: Apache-2.0
"""A model of a whole record by recursive least squares, and how well it tells the record (`satvib identify`)."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from rich.console import Console
from rich.table import Table
from satvib_common.errors import SatvibError
from satvib_ident.iir_model import IirModel
from satvib_ident.recursive_least_squares import RecursiveLeastSquares

Array = NDArray[np.float64]


@dataclass(frozen=True)
class Identified:
    """A model and its fits, 1 - |y - yhat| / |y - mean y| over the samples after the first n."""

    model: IirModel
    standard_deviation: Array
    samples: int
    fit_one_step: float
    fit_free_run: float


def identify_record(
    u: Array, y: Array, dt: float, poles: int, coefficients: int, delay: int
) -> Identified:
    """Identify a model of a record.

    Args:
        u: (samples,) input, V.
        y: (samples,) output, m/s^2.
        dt: s.
        poles: n.
        coefficients: m.
        delay: samples from an input to the first output that it reaches.

    Raises:
        SatvibError: too short a record for so many parameters.
    """
    count = poles + coefficients
    first = max(poles, delay + coefficients - 1)
    if len(y) - first < 2 * count:
        raise SatvibError(f'{len(y)} samples are too few for {count} parameters')
    estimator = RecursiveLeastSquares(count)
    for k in range(first, len(y)):
        past = -y[k - 1 : k - poles - 1 if k > poles else None : -1]
        late = k - delay
        inputs = u[late : late - coefficients if late >= coefficients else None : -1]
        estimator.update(np.concatenate([past, inputs]), y[k])
    theta = estimator.theta
    model = IirModel(theta[:poles], theta[poles:], delay, dt)
    spread = np.linalg.norm(y[first:] - y[first:].mean())

    def fit(modelled: Array) -> float:
        return float(1.0 - np.linalg.norm(y[first:] - modelled[first:]) / spread)

    deviation = np.sqrt(np.diagonal(estimator.covariance))
    one_step = fit(model.predict(y, u))
    free_run = fit(model.simulate(u, y[:first]))
    return Identified(model, deviation, len(y) - first, one_step, free_run)


def show_model(console: Console, found: Identified, name: str) -> None:
    """Print a model, its poles and its fits."""
    model = found.model
    table = Table(title=f'{name}: {model.order} poles, {model.b.size} coefficients')
    for heading in ('parameter', 'value', 'std. deviation'):
        table.add_column(heading, justify='right')
    names = [f'a{i + 1}' for i in range(model.order)] + [f'b{i + 1}' for i in range(model.b.size)]
    for label, value, deviation in zip(names, model.theta, found.standard_deviation, strict=True):
        table.add_row(label, f'{value:.9g}', f'{deviation:.2g}')
    console.print(table)
    poles = Table(title='poles')
    for heading in ('z', '|z|', 'frequency [Hz]', 'damping ratio'):
        poles.add_column(heading, justify='right')
    for pole in model.poles():
        s = np.log(pole) / model.dt if pole != 0 else complex(-np.inf)
        hertz, damping = abs(s) / (2 * np.pi), -s.real / abs(s)
        poles.add_row(f'{pole:.6f}', f'{abs(pole):.6f}', f'{hertz:.4g}', f'{damping:.4f}')
    console.print(poles)
    stable = 'stable' if bool(model.is_stable()) else 'NOT stable'
    console.print(
        f'fit: one step {found.fit_one_step:.4f}, free run {found.fit_free_run:.4f} '
        f'over {found.samples} samples; the model is {stable}'
    )
