# SPDX-FileCopyrightText: 2026 The satvib authors
# SPDX-License-Identifier: Apache-2.0
"""The rows of a sweep as Markdown tables, and how they come into a page.

A page marks the place of a table by two comments, between which everything is written again:

    <!-- table laws -->
    <!-- end -->
"""

import re
from collections.abc import Sequence
from pathlib import Path
from typing import Any

from satvib_common.errors import SatvibError

from satvib_studies.sweep.sweep import SweepSummary

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
        numbers: dict[str, int] = {}
        for row in (row for row in rows if row['labels'][first] == head):
            cells = [row['labels'][axis] for axis in axes]
            cells += [_number(row['worst'][name], name) for name, _ in COLUMNS]
            marks = sorted(numbers.setdefault(text, len(numbers) + 1) for text in row['reasons'])
            cells[-1] += ''.join(f' [{number}]' for number in marks)
            lines.append(f'| {" | ".join(cells)} |')
        lines += ['', *(f'[{number}] {text}.  ' for text, number in numbers.items())]
        parts.append('\n'.join(lines).rstrip())
    return '\n\n'.join(parts) + '\n'


def summary(rows: Sequence[dict[str, Any]], what: SweepSummary) -> str:
    """Give a short table: tone as measured / tone in truth / RMS in truth, dB, the worst strut.

    0 V stands where the law refused to act.
    """
    kept = [r for r in rows if all(r['labels'][a] == v for a, v in what.fixed.items())]
    across = list(dict.fromkeys(r['labels'][what.column] for r in kept))
    table = []
    for down in dict.fromkeys(r['labels'][what.row] for r in kept):
        cells = {r['labels'][what.column]: r for r in kept if r['labels'][what.row] == down}
        table.append([down, *(_short(cells[name]) for name in across)])
    return plain_markdown([what.row, *across], table)


def _short(row: dict[str, Any]) -> str:
    kinds = ('measured_tone', 'true_tone', 'true_rms')
    if not row['worst']['largest_control_voltage']:
        return '0 V'
    return ' / '.join(_number(row['worst'][kind], kind) for kind in kinds)


def fill(page: Path, tables: dict[str, str]) -> int:
    """Write tables between the marks of a page that exists.

    Args:
        page: Markdown.
        tables: by what stands in the opening mark.

    Returns:
        How many there were.

    Raises:
        SatvibError: the page cannot be read, or has no mark of these.
    """
    try:
        text = page.read_text(encoding='utf-8')
    except (OSError, UnicodeDecodeError) as error:
        raise SatvibError(f'{page}: cannot be read: {error}') from None
    count = 0
    for name, table in tables.items():
        mark = re.compile(rf'(<!-- {re.escape(name)} -->\n).*?(<!-- end -->)', re.DOTALL)
        text, found = mark.subn(lambda m, new=table: f'{m[1]}{new}{m[2]}', text)  # type: ignore[misc]
        count += found
    if not count:
        marks = ' or '.join(f'<!-- {name} -->' for name in tables)
        raise SatvibError(f'{page}: no mark {marks}; put one where the table belongs')
    page.write_text(text, encoding='utf-8')
    return count


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
