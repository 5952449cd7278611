# SPDX-FileCopyrightText: 2026 The satvib authors
# SPDX-License-Identifier: Apache-2.0
"""The rows of a study as Markdown tables."""

from collections.abc import Sequence
from typing import Any

COLUMNS = (
    ('measured_rms', 'RMS, measured dB'),
    ('true_rms', 'RMS, true dB'),
    ('measured_tone', 'tone, measured dB'),
    ('true_tone', 'tone, true dB'),
    ('noise_floor', 'noise floor dB'),
    ('settling_time', 'settled s'),
    ('largest_amplification', 'largest amplification dB'),
    ('largest_voltage', 'largest voltage V'),
)


def markdown(rows: Sequence[dict[str, Any]]) -> str:
    """Give one table per label of the first axis; of several struts the worst is shown.

    What the laws said at the end is below each table.
    """
    first, *axes = rows[0]['labels']
    parts = []
    for head in dict.fromkeys(row['labels'][first] for row in rows):
        lines = [
            f'### {head}',
            '',
            '| ' + ' | '.join([*axes, *(heading for _, heading in COLUMNS)]) + ' |',
            '|' + '---|' * len(axes) + '---:|' * len(COLUMNS),
        ]
        told: dict[str, int] = {}
        for row in (row for row in rows if row['labels'][first] == head):
            cells = [row['labels'][axis] for axis in axes]
            cells += [_number(row['worst'][name], name) for name, _ in COLUMNS]
            marks = sorted(told.setdefault(text, len(told) + 1) for text in row['reasons'])
            cells[-1] += ''.join(f' [{number}]' for number in marks)
            lines.append(f'| {" | ".join(cells)} |')
        lines += ['', *(f'[{number}] {text}.  ' for text, number in told.items())]
        parts.append('\n'.join(lines).rstrip())
    return '\n\n'.join(parts) + '\n'


def plain_markdown(headings: Sequence[str], rows: Sequence[Sequence[str]]) -> str:
    """Give one Markdown table of texts."""
    lines = [f'| {" | ".join(headings)} |', '|' + '---|' * len(headings)]
    lines += [f'| {" | ".join(row)} |' for row in rows]
    return '\n'.join(lines) + '\n'


def _number(value: float | None, name: str) -> str:
    if value is None:
        return '–'
    if name in {'settling_time', 'largest_voltage'}:
        return f'{value:.1f}'
    return f'{value:+.1f}'
