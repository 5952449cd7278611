# SPDX-FileCopyrightText: 2026 The satvib authors
# SPDX-License-Identifier: Apache-2.0
"""The rows of a study as Markdown tables, one per rig."""

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
    """Give one table per rig; of several struts the worst is shown. What a law said is below its table."""
    parts = []
    for rig in dict.fromkeys(row['rig'] for row in rows):
        mine = [row for row in rows if row['rig'] == rig]
        lines = [
            f'### {rig}',
            '',
            '| disturbance | law | ' + ' | '.join(heading for _, heading in COLUMNS) + ' |',
            '|---|---|' + '---:|' * len(COLUMNS),
        ]
        told: dict[str, int] = {}
        for row in mine:
            cells = [_number(row['worst'][name], name) for name, _ in COLUMNS]
            marks = [told.setdefault(text, len(told) + 1) for text in row['reasons']]
            mark = ''.join(f' [{number}]' for number in sorted(marks))
            lines.append(f'| {row["disturbance"]} | {row["law"]}{mark} | {" | ".join(cells)} |')
        lines += ['', *(f'[{number}] {text}.  ' for text, number in told.items())]
        parts.append('\n'.join(lines).rstrip())
    return '\n\n'.join(parts) + '\n'


def _number(value: float | None, name: str) -> str:
    if value is None:
        return '–'
    if name in {'settling_time', 'largest_voltage'}:
        return f'{value:.1f}'
    return f'{value:+.1f}'
