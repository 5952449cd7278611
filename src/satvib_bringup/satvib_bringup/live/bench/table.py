# SPDX-FileCopyrightText: 2026 The satvib authors
# SPDX-License-Identifier: Apache-2.0
"""The figures of a bench as tables, for the terminal and for pages."""

from collections.abc import Callable
from typing import Any

Show = Callable[[float], str]

_PERCENT: Show = lambda value: f'{100.0 * value:.2f} %'  # noqa: E731
_MS: Show = lambda value: f'{value:.2f}'  # noqa: E731

# figure, heading, how it is shown; the ratio to the floor stands behind those with a mark
_COLUMNS: tuple[tuple[str, str, Show, bool], ...] = (
    ('samples_per_s', 'samples/s', lambda value: f'{value:.0f}', True),
    ('cpu', 'CPU ms/sample', _MS, True),
    ('p50', 'p50 ms', _MS, True),
    ('p99', 'p99 ms', _MS, True),
    ('p999', 'p99.9 ms', _MS, False),
    ('most', 'max ms', _MS, False),
    ('late', 'late', _PERCENT, False),
    ('missed', 'missed', _PERCENT, False),
    ('late_samples', 'late samples', lambda value: f'{value:.0f}', False),
    ('start', 'start s', lambda value: f'{value:.1f}', True),
    ('memory', 'MB a process', lambda value: f'{value:.0f}', False),
    ('memory_all', 'MB in all', lambda value: f'{value:.0f}', False),
)


def rows(case: dict[str, Any]) -> tuple[list[str], list[list[str]]]:
    """Give headings and cells of a case; columns that no graph has are left out."""
    graphs = case['graphs']
    shown = [c for c in _COLUMNS if any(c[0] in g['median'] for g in graphs.values())]
    head = ['graph', *(heading for _, heading, _, _ in shown)]
    body = []
    for name, graph in graphs.items():
        cells = [name]
        for key, _, show, has_ratio in shown:
            value, ratio = graph['median'].get(key), graph['ratio'].get(key)
            text = '–' if value is None else show(value)
            low, high = graph['span'].get(key, (value, value))
            if value is not None and has_ratio and ratio is not None and name != next(iter(graphs)):
                text += f' (x {ratio:.2f})'
            if value is not None and key == 'p99' and low != high:
                text += f' [{show(low)} to {show(high)}]'
            cells.append(text)
        body.append(cells)
    return head, body


def markdown(found: dict[str, Any]) -> str:
    """Give all tables as Markdown."""
    machine, rounds = found['machine'], found['rounds']
    medians = f'medians of {rounds} rounds, and how far p99 scatters'
    lines = [
        (
            f'{machine["processors"]} processors, Python {machine["python"]}; '
            f'{medians if rounds > 1 else "one round"}.'
        ),
    ]
    for case in found['cases']:
        head, body = rows(case)
        lines += ['', f'**{case["name"]}, {case["case"]["seconds"]:g} s**', '']
        lines += [f'| {" | ".join(head)} |', '|' + '---|' * len(head)]
        lines += [f'| {" | ".join(row)} |' for row in body]
        for name, graph in case['graphs'].items():
            lines += [f'\n{name} failed: {text}' for text in graph['failed']]
    return '\n'.join(lines) + '\n'
