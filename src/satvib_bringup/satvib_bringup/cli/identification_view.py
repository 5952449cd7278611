# SPDX-FileCopyrightText: 2026 The satvib authors
# SPDX-License-Identifier: Apache-2.0
"""What `satvib identify` prints: orders compared, the model chosen, its poles, its fits, its residual."""

import math

import numpy as np
from rich.console import Console
from rich.table import Table
from satvib_ident.offline.order_search import Candidate, OfflineResult


def show_identification(console: Console, result: OfflineResult, name: str) -> None:
    """Print an offline identification."""
    if len(result.candidates) > 1:
        console.print(_orders(result))
    console.print(_parameters(result.chosen, name))
    console.print(_poles(result.chosen))
    chosen, tests = result.chosen, result.tests
    stable = 'stable' if bool(chosen.model.is_stable()) else 'NOT stable'
    console.print(f'order {chosen.name}: {result.reason}; the model is {stable}')
    console.print(
        f'fit: one step {chosen.one_step:.4f}, free run {_fit(chosen.free_run)}; on the validation '
        f'part, not seen before: one step {_fit(chosen.validation_one_step)}, '
        f'free run {_fit(chosen.validation_free_run)}'
    )
    white = 'white' if tests.p_value > 0.01 else 'not white'
    console.print(
        f'residual: {white} (p = {tests.p_value:.2g}); within the 99 % bound of independence from '
        f'the input at {100 * tests.independent_share:.0f} % of the lags'
    )


def _fit(value: float) -> str:
    return f'{value:.4f}' if math.isfinite(value) else 'runs away'


def _orders(result: OfflineResult) -> Table:
    table = Table(title='orders compared: poles/coefficients')
    for heading in (
        'order', 'one step', 'free run', 'validation:\none step', 'validation:\nfree run', 'AIC',
        'BIC',
    ):  # fmt: skip
        table.add_column(heading, justify='right')
    for c in result.candidates:
        fits = (c.one_step, c.free_run, c.validation_one_step, c.validation_free_run)
        mark = ' ←' if c is result.chosen else ''
        table.add_row(
            c.name + mark,
            *(_fit(f) for f in fits),
            f'{c.aic:.1f}',
            f'{c.bic:.1f}',
            style='bold' if c is result.chosen else None,
        )
    return table


def _parameters(chosen: Candidate, name: str) -> Table:
    model = chosen.model
    table = Table(title=f'{name}: model {chosen.name}')
    for heading in ('parameter', 'value', 'std. deviation'):
        table.add_column(heading, justify='right')
    labels = [f'a{i + 1}' for i in range(model.order)]
    labels += [f'b{i + 1}' for i in range(model.b.shape[-1])]
    for label, value, deviation in zip(labels, model.theta, chosen.standard_deviation, strict=True):
        table.add_row(label, f'{value:.9g}', f'{deviation:.2g}')
    return table


def _poles(chosen: Candidate) -> Table:
    model = chosen.model
    table = Table(title='poles')
    for heading in ('z', '|z|', 'frequency [Hz]', 'damping ratio'):
        table.add_column(heading, justify='right')
    for pole in model.poles():
        if abs(pole) == 0.0:
            table.add_row('0', '0', '–', '–')
            continue
        s = np.log(complex(pole)) / model.dt
        damping = f'{-s.real / abs(s):.4f}' if abs(s) else '–'
        table.add_row(f'{pole:.6f}', f'{abs(pole):.6f}', f'{abs(s) / (2 * math.pi):.4g}', damping)
    return table
