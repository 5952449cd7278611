# SPDX-FileCopyrightText: 2026 The satvib authors
# SPDX-License-Identifier: Apache-2.0
"""What `satvib frf` prints: the figures of merit of every transmissibility, the paths, the coupling."""

from typing import Any

from rich.console import Console
from rich.table import Table

_DASH = '–'


def show_frf(console: Console, mapping: dict[str, Any]) -> None:
    """Print what frf.json holds."""
    curves = mapping['curves']
    transmitted = [c for c in curves if c['quantity'] == 'transmissibility']
    paths = [c for c in curves if c['quantity'] == 'path']
    if transmitted:
        console.print(_transmissibility(transmitted, mapping['source']))
    if paths:
        console.print(_paths(paths))
    if mapping['coupling']:
        console.print(_coupling(mapping['coupling'], [c['input'] for c in paths]))
    for method in dict.fromkeys(c['method'] for c in curves):
        console.print(f'• {method}')
    for note in mapping['notes']:
        console.print(f'• {note}')


def _transmissibility(curves: list[dict[str, Any]], source: str) -> Table:
    table = Table(title=f'{source}: transmissibility')
    table.add_column('loop')
    table.add_column('output')
    for heading in (
        'peak\ndB', 'at\nHz', 'isolation\nfrom Hz', 'roll-off\ndB/decade', 'coherence\nmedian',
        'from exact\ndB', 'from exact\ndeg',
    ):  # fmt: skip
        table.add_column(heading, justify='right')
    for curve in curves:
        merit = curve['merit'] or {}
        table.add_row(
            curve['loop'].replace('_', ' '),
            _output(curve),
            _number(merit.get('peak'), 1, signed=True),
            _number(merit.get('peak_frequency'), 2),
            _number(merit.get('isolation_from'), 2),
            _number(merit.get('roll_off'), 1),
            _number(curve['coherence'], 4),
            _number(curve['deviation_db'], 2),
            _number(curve['deviation_degrees'], 1),
        )
    return table


def _output(curve: dict[str, Any]) -> str:
    """Name of what was measured; with the motion of the base where that is not simply up and down."""
    output, base = (str(curve[key]).replace('_', ' ') for key in ('output', 'input'))
    return f'{output} / {base}' if base.startswith('base ') else output


def _paths(curves: list[dict[str, Any]]) -> Table:
    table = Table(title='voltage to acceleration, each coil and its own strut')
    table.add_column('strut')
    for heading in ('band\nHz', 'coherence\nmedian', 'from exact\ndB', 'from exact\ndeg'):
        table.add_column(heading, justify='right')
    for curve in curves:
        if curve['output'] == curve['input'] or len(curves) == 1:
            table.add_row(
                curve['output'].replace('_', ' '),
                f'{curve["lowest"]:.3g} to {curve["highest"]:.3g}',
                _number(curve['coherence'], 4),
                _number(curve['deviation_db'], 2),
                _number(curve['deviation_degrees'], 1),
            )
    return table


def _coupling(coupling: dict[str, Any], inputs: list[str]) -> Table:
    struts = list(dict.fromkeys(inputs))
    table = Table(title='coupling: reading of a strut over that of the driven one, at its peak')
    table.add_column('reading')
    for strut, frequency in zip(struts, coupling['frequency'], strict=True):
        table.add_column(f'{strut.replace("_", " ")}\n{frequency:.2f} Hz', justify='right')
    for strut, row in zip(struts, coupling['ratio'], strict=True):
        table.add_row(strut.replace('_', ' '), *(_number(value, 3) for value in row))
    return table


def _number(value: float | None, digits: int, signed: bool = False) -> str:
    """Show a number; a dash for what is not known."""
    if value is None:
        return _DASH
    return f'{value:+.{digits}f}' if signed else f'{value:.{digits}f}'
