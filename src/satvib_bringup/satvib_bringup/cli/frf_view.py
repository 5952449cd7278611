# SPDX-FileCopyrightText: 2026 The satvib authors
# SPDX-License-Identifier: Apache-2.0
"""What `satvib frf` prints: the figures of merit of every transmissibility, the paths, the coupling."""

from typing import Any

from rich.console import Console
from rich.table import Table

_DASH = '–'
_COHERENCE = 'coherence:\nmedian, least at Hz'
_EXACT = 'from exact\ndB, deg'
_COLUMNS = {
    'peak': 'peak', 'isolation_from': 'isolation', 'roll_off': 'roll-off', 'deviation': 'from exact',
}  # fmt: skip


def show_frf(console: Console, mapping: dict[str, Any]) -> None:
    """Print what frf.json holds."""
    for line in mapping['shortfalls']:
        console.print(f'THE RECORDED RUN IS NO RESULT: {line}', style='bold red')
    for line in mapping['warnings']:
        console.print(f'WARNING: {line}', style='yellow')
    curves = mapping['curves']
    transmitted = [c for c in curves if c['quantity'] == 'transmissibility']
    paths = [c for c in curves if c['quantity'] == 'path']
    if transmitted:
        console.print(_transmissibility(transmitted, mapping['source']))
    if paths:
        console.print(_paths(paths))
    if mapping['coupling']:
        console.print(_coupling(mapping['coupling'], [c['input'] for c in paths]))
    for reason in _reasons([*transmitted, *(c for c in paths if _is_shown(c, paths))]):
        console.print(f'• {reason}')
    for method in dict.fromkeys(c['method'] for c in curves):
        console.print(f'• {method}')
    for note in mapping['notes']:
        console.print(f'• {note}')


def _transmissibility(curves: list[dict[str, Any]], source: str) -> Table:
    table = Table(title=f'{source}: transmissibility')
    table.add_column('loop')
    table.add_column('output')
    for heading in (
        'peak\ndB', 'at\nHz', 'isolation\nfrom Hz', 'roll-off\ndB/decade', _COHERENCE, _EXACT,
    ):  # fmt: skip
        table.add_column(heading, justify='right')
    for curve, loop in zip(curves, _loops(curves), strict=True):
        merit = curve['merit'] or {}
        if loop and loop[0] != '+':
            table.add_section()
        table.add_row(
            loop,
            _output(curve),
            _number(merit.get('peak'), 1, signed=True),
            _frequency(merit.get('peak_frequency')),
            _frequency(merit.get('isolation_from')),
            _number(merit.get('roll_off'), 1),
            _coherence(curve),
            _deviation(curve),
        )
    return table


def _output(curve: dict[str, Any]) -> str:
    """Name of what was measured; with the motion of the base where that is not simply up and down."""
    output, base = (str(curve[key]).replace('_', ' ') for key in ('output', 'input'))
    return f'{output} / {base}' if base.startswith('base ') else output


def _loops(curves: list[dict[str, Any]]) -> list[str]:
    """What stands in the column of the loop: its name beside its first rows, a law of several in as many."""
    cells: list[str] = []
    for loop in dict.fromkeys(curve['loop'] for curve in curves):
        rows = sum(curve['loop'] == loop for curve in curves)
        parts = loop.replace('_', ' ').replace('+', '\n+').split('\n')
        parts = parts if len(parts) <= rows else [''.join(parts)]
        cells += [*parts, *[''] * (rows - len(parts))]
    return cells


def _paths(curves: list[dict[str, Any]]) -> Table:
    table = Table(title='voltage to acceleration, each coil and its own strut')
    table.add_column('strut')
    for heading in ('band\nHz', _COHERENCE, _EXACT):
        table.add_column(heading, justify='right')
    for curve in curves:
        if _is_shown(curve, curves):
            table.add_row(
                curve['output'].replace('_', ' '),
                f'{curve["lowest"]:.3g} to {curve["highest"]:.3g}',
                _coherence(curve),
                _deviation(curve),
            )
    return table


def _coherence(curve: dict[str, Any]) -> str:
    """The median of the coherence, and its least value with the frequency."""
    if curve['coherence'] is None:
        return _DASH
    least, at = curve['coherence_least'], curve['coherence_least_frequency']
    return f'{curve["coherence"]:.4f}, {least:.4f} at {at:.3g}'


def _deviation(curve: dict[str, Any]) -> str:
    if curve['deviation_db'] is None:
        return _DASH
    return f'{curve["deviation_db"]:.2f}, {curve["deviation_degrees"]:.1f}'


def _reasons(curves: list[dict[str, Any]]) -> list[str]:
    """Say why there is a dash, each reason once, with the loops or the outputs that it is about."""
    found: dict[str, tuple[dict[str, None], list[dict[str, Any]]]] = {}
    for curve in curves:
        for key, reason in curve['unknown'].items():
            columns, of = found.setdefault(reason, ({}, []))
            columns[_COLUMNS[key]] = None
            of.append(curve)
    lines = []
    for reason, (columns, of) in found.items():
        loops = {c['loop'] for c in of}
        whole = all(c in of for c in curves if c['loop'] in loops)
        key = 'loop' if whole and len({c['loop'] for c in curves}) > 1 else 'output'
        names = dict.fromkeys(c[key].replace('_', ' ') for c in of)
        lines.append(f'{_DASH} ({", ".join(columns)}; {", ".join(names)}): {reason}')
    return lines


def _is_shown(curve: dict[str, Any], paths: list[dict[str, Any]]) -> bool:
    """Whether a path has a line: that of a coil to its own strut, or the only one."""
    return curve['output'] == curve['input'] or len(paths) == 1


def _coupling(coupling: dict[str, Any], inputs: list[str]) -> Table:
    struts = list(dict.fromkeys(inputs))
    table = Table(title='coupling: reading of a strut over that of the driven one, at its peak')
    table.add_column('reading')
    for strut, frequency in zip(struts, coupling['frequency'], strict=True):
        table.add_column(f'{strut.replace("_", " ")}\n{_frequency(frequency)} Hz', justify='right')
    for strut, row in zip(struts, coupling['ratio'], strict=True):
        table.add_row(strut.replace('_', ' '), *(_number(value, 3) for value in row))
    return table


def _number(value: float | None, digits: int, signed: bool = False) -> str:
    """Show a number; a dash for what is not known."""
    if value is None:
        return _DASH
    return f'{value:+.{digits}f}' if signed else f'{value:.{digits}f}'


def _frequency(value: float | None) -> str:
    """Show a frequency in Hz with three digits that count; a dash for what is not known."""
    return _DASH if value is None else f'{value:#.3g}'.rstrip('.')
