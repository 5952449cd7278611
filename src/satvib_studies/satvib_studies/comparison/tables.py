# SPDX-FileCopyrightText: 2026 The satvib authors
# SPDX-License-Identifier: Apache-2.0
"""The tables of a comparison as Markdown, and its numbers as plain data."""

from __future__ import annotations

from typing import Any

import numpy as np
from satvib_common.arrays import Array

from satvib_studies.comparison.cases import OPEN
from satvib_studies.comparison.runs import ComparisonResult

_HEADINGS = {
    'before': 'before the event',
    'after': 'in the 3 s after it',
    'settled': 'settled',
}


def spread(values: Array) -> str:
    """Median, and the best and the worst."""
    return f'{np.median(values):+.1f} ({values.min():+.1f} … {values.max():+.1f})'


def attenuation_table(found: ComparisonResult, window: str) -> str:
    """Give the attenuation of every scheme in every case, dB; the best median of a row in bold."""
    c = found.comparison
    schemes = list(c.schemes)
    titles = [s.title for s in c.scheme_list().values()]
    lines = [f'| {_HEADINGS.get(window, window)} | ' + ' | '.join(titles) + ' |']
    lines.append('|---|' + '---:|' * len(schemes))
    for name, case in c.case_list().items():
        rows = [found.attenuation(s, name, window) for s in schemes]
        best = int(np.argmin([np.median(r) for r in rows]))
        cells = [f'**{spread(r)}**' if i == best else spread(r) for i, r in enumerate(rows)]
        lines.append(f'| {case.title} | ' + ' | '.join(cells) + ' |')
    return '\n'.join(lines) + '\n'


def tilt_table(found: ComparisonResult, window: str = 'settled') -> str:
    """Give the RMS of the tilts, mm/s^2 at the struts' circle."""
    c = found.comparison
    schemes = [OPEN, *c.schemes]
    heads = ['0 V', *(s.title for s in c.scheme_list().values())]
    lines = [f'| tilts, mm/s² RMS, {_HEADINGS.get(window, window)} | ' + ' | '.join(heads) + ' |']
    lines.append('|---|' + '---:|' * len(heads))
    for name, case in c.case_list().items():
        cells = [f'{1e3 * np.median(found.tilt_rms(s, name, window)):.1f}' for s in schemes]
        lines.append(f'| {case.title} | ' + ' | '.join(cells) + ' |')
    return '\n'.join(lines) + '\n'


def voltage_table(found: ComparisonResult) -> str:
    """Give the largest voltage of each scheme in the whole run, V."""
    c = found.comparison
    titles = [s.title for s in c.scheme_list().values()]
    lines = ['| largest voltage, V | ' + ' | '.join(titles) + ' |']
    lines.append('|---|' + '---:|' * len(titles))
    for i, case in enumerate(c.case_list().values()):
        cells = [f'{np.median(found.voltage[s][i]):.1f}' for s in c.schemes]
        lines.append(f'| {case.title} | ' + ' | '.join(cells) + ' |')
    return '\n'.join(lines) + '\n'


def tables(found: ComparisonResult) -> dict[str, str]:
    """Give all tables by the marks of the page that they belong to."""
    made = {
        f'compare {window}': attenuation_table(found, window) for window in ('after', 'settled')
    }
    return made | {'compare tilts': tilt_table(found), 'compare voltages': voltage_table(found)}


def plain(found: ComparisonResult) -> dict[str, Any]:
    """Give the numbers: by case and scheme, attenuation by window seed by seed, tilts, voltage."""
    c = found.comparison
    result: dict[str, Any] = {'comparison': c.to_mapping(), 'cases': {}}
    for i, case in enumerate(c.cases):
        result['cases'][case] = {
            scheme: {
                **{w: found.attenuation(scheme, case, w).tolist() for w in c.windows},
                'tilts': found.tilt_rms(scheme, case, 'settled').tolist(),
                'largest_voltage': found.voltage[scheme][i].tolist(),
            }
            for scheme in c.schemes
        }
    return result
