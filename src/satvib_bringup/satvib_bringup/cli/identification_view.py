# SPDX-FileCopyrightText: 2026 The satvib authors
# SPDX-License-Identifier: Apache-2.0
"""What `satvib identify` prints: orders compared, the model chosen, its poles, its fits, its residual."""

import math
from collections.abc import Iterator, Sequence
from contextlib import contextmanager

import numpy as np
from rich.console import Console
from rich.progress import BarColumn, Progress, TextColumn, TimeElapsedColumn
from rich.table import Table
from satvib_ident.offline.compressed import Progress as Report
from satvib_ident.offline.compressed import quiet
from satvib_ident.offline.result import Candidate, OfflineResult


@contextmanager
def show_progress(console: Console, title: str) -> Iterator[Report]:
    """Show how far an identification is, where there is a terminal; give what it calls."""
    if not console.is_terminal:
        yield quiet
        return
    columns = (
        TextColumn('{task.description}', markup=False), BarColumn(bar_width=24),
        TextColumn('{task.fields[what]}', markup=False), TimeElapsedColumn(),
    )  # fmt: skip
    with Progress(*columns, console=console, transient=True) as bar:
        task = bar.add_task(title, total=1.0, what='')
        yield lambda share, what: bar.update(task, completed=share, what=what)


def show_identification(
    console: Console, result: OfflineResult, name: str, notes: Sequence[str] = ()
) -> None:
    """Print an offline identification; `notes` are those of the record."""
    for note in (*notes, *result.notes):
        console.print(f'• {note}')
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
        f'the input at {100 * tests.independent_share:.0f} % of the lags 0 to {tests.lags}'
    )
    for found in result.findings:
        console.print(f'{"•" if found.finding.trusted else "NOT TRUSTED,"} {found}')
    if result.trusted:
        console.print('nothing found speaks against the model')


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
