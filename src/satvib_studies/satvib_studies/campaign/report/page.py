# SPDX-FileCopyrightText: 2026 The satvib authors
# SPDX-License-Identifier: Apache-2.0
"""The report of a campaign: report.html, summary.json and figures/, from the table of its trials."""

from __future__ import annotations

import base64
import json
from pathlib import Path
from typing import Any

import jinja2
import numpy as np
import pyarrow as pa
import yaml
from numpy.typing import NDArray
from satvib_common.arrays import Array
from satvib_common.errors import SatvibError
from satvib_common.files.whole_file import write_whole
from satvib_experiment.report.page import number, significant
from satvib_experiment.report.result import versions

from satvib_studies.campaign.measures.sensitivity import Sensitivity, ranking
from satvib_studies.campaign.report import figures as drawing
from satvib_studies.campaign.report.table import PARAMETER
from satvib_studies.campaign.trials import TrialPlan

FORMAT = 'satvib campaign summary 1'
WORST = 10
# what the tables show, with unit and name for people
SHOWN = {
    'attenuation_true_rms': ('true RMS', 'dB'),
    'attenuation_true_tone': ('true tone', 'dB'),
    'attenuation_measured_rms': ('measured RMS', 'dB'),
    'attenuation_measured_tone': ('measured tone', 'dB'),
    'voltage_peak': ('largest voltage', 'V'),
    'saturated_share': ('share of samples limited', ''),
    'stroke_peak': ('largest stroke', 'm'),
    'force_peak': ('largest coil force', 'N'),
}
_POINTS = (0.0, 5.0, 25.0, 50.0, 75.0, 95.0, 100.0)


def column(table: pa.Table, name: str) -> NDArray[Any]:
    """Give a column as an array."""
    return np.asarray(table[name].to_numpy(zero_copy_only=False))


def summarize(plan: TrialPlan, table: pa.Table) -> dict[str, Any]:
    """Give what the report says, as plain data; unknown is None.

    Raises:
        SatvibError: the figure by which the campaign judges is not one of its columns.
    """
    campaign, judge = plan.campaign, plan.campaign.judge
    if judge not in table.column_names or column(table, judge).dtype.kind not in 'fiu':
        if all(column(table, 'error')):
            raise SatvibError(f'campaign {campaign.name}: no trial ran: {table["error"][0]}')
        known = ', '.join(n for n in SHOWN if n in table.column_names)
        raise SatvibError(f'judge: {judge} is not a figure of a trial; for instance {known}')
    figure = column(table, judge).astype(float)
    parameters = {k: column(table, PARAMETER + k) for k in plan.values}
    errors = [str(e) for e in column(table, 'error')]
    order = sorted(np.flatnonzero(np.isfinite(figure)), key=lambda i: (-figure[i], i))
    faults = column(table, 'faults') if 'faults' in table.column_names else np.zeros(1)
    return {
        'format': FORMAT,
        'campaign': campaign.to_mapping(),
        'trials': table.num_rows,
        'failed': sum(1 for e in errors if e),
        'errors': sorted({e for e in errors if e})[:10],
        'with_fault': int(np.count_nonzero(faults)),
        'without_figure': int(np.count_nonzero(~np.isfinite(figure))),
        'louder_than_without_control': int(
            np.count_nonzero(_of(table, 'attenuation_true_rms') > 0)
        ),
        'spread': {name: _spread(_of(table, name)) for name in SHOWN if name in table.column_names},
        'sensitivity': [_texts(s) for s in ranking(parameters, figure)],
        'worst': [_case(plan, table, int(i), judge) for i in order[:WORST]],
        'median': [_case(plan, table, int(i), judge) for i in order[len(order) // 2 :][:1]],
        'best': [_case(plan, table, int(i), judge) for i in order[-1:]],
        'versions': versions(),
    }


def _of(table: pa.Table, name: str) -> Array:
    if name not in table.column_names:
        return np.full(table.num_rows, np.nan)
    return column(table, name).astype(float)


def _spread(values: Array) -> list[float | None]:
    good = values[np.isfinite(values)]
    return [float(v) for v in np.percentile(good, _POINTS)] if len(good) else [None] * len(_POINTS)


def _texts(item: Sensitivity) -> dict[str, Any]:
    return {'key': item.key, 'share': _finite(item.share), 'rank': _finite(item.rank)}


def _finite(value: float) -> float | None:
    return float(value) if np.isfinite(value) else None


def _case(plan: TrialPlan, table: pa.Table, trial: int, judge: str) -> dict[str, Any]:
    return {
        'trial': trial,
        'seed': plan.seeds[trial],
        'figure': _finite(float(column(table, judge)[trial])),
        'parameters': {key: values[trial] for key, values in plan.values.items()},
        'reason': str(table['reason'][trial]) if 'reason' in table.column_names else '',
        'command': plan.command(trial),
    }


def write_report(plan: TrialPlan, table: pa.Table, folder: Path) -> dict[str, Any]:
    """Write report.html, summary.json and figures/, and give what the summary holds.

    What a former report of the same campaign left there is replaced; it follows from the table alone.

    Raises:
        SatvibError: the folder cannot be written.
    """
    summary = summarize(plan, table)
    try:
        pictures = folder / 'figures'
        pictures.mkdir(exist_ok=True)
        sections = _draw(plan, table, pictures)
        _put(folder / 'summary.json', json.dumps(summary, indent=1, allow_nan=False) + '\n')
        _put(folder / 'report.html', _page(plan, summary, sections))
    except (OSError, SatvibError) as error:
        why = getattr(error, 'strerror', None) or error
        raise SatvibError(
            f'{folder}: the report cannot be written: {why}; the trials are in '
            f'{folder / "trials.parquet"}, try again with: ./satvib campaign --resume {folder}'
        ) from None
    return summary


def _put(path: Path, text: str) -> None:
    write_whole(path, lambda sink: sink.write(text.encode()))


def _draw(plan: TrialPlan, table: pa.Table, folder: Path) -> list[tuple[str, str, str]]:
    """Draw, and give heading, source and caption of every figure."""
    judge = plan.campaign.judge
    parameters = {k: column(table, PARAMETER + k) for k in plan.values}
    figure = _of(table, judge)
    found = ranking(parameters, figure)
    spread = {n: _of(table, n) for n in SHOWN}
    keys = [s.key for s in found]
    paths = {name: folder / f'{name}.png' for name in ('spread', 'sensitivity', 'shapes')}
    done = {
        'spread': drawing.draw_spread(spread, paths['spread']),
        'sensitivity': drawing.draw_shares(found, judge, paths['sensitivity']),
        'shapes': drawing.draw_shapes(parameters, figure, judge, keys, paths['shapes']),
    }
    texts = {
        'spread': ('How good, how often', drawing.SPREAD),
        'sensitivity': ('What it depends on', drawing.SHARE),
        'shapes': ('How it depends on them', drawing.SHAPE),
    }
    sections = []
    for name, path in paths.items():
        heading, caption = texts[name]
        if done[name]:
            data = base64.b64encode(path.read_bytes()).decode('ascii')
            sections.append((heading, f'data:image/png;base64,{data}', caption))
    return sections


def _page(plan: TrialPlan, summary: dict[str, Any], sections: list[tuple[str, str, str]]) -> str:
    own = jinja2.PackageLoader('satvib_studies', 'campaign/report')
    style = jinja2.PackageLoader('satvib_experiment', 'report')
    environment = jinja2.Environment(
        loader=jinja2.ChoiceLoader([own, style]), autoescape=True, trim_blocks=True,
        lstrip_blocks=True, undefined=jinja2.StrictUndefined,
    )  # fmt: skip
    environment.filters |= {'number': number, 'significant': significant}
    return environment.get_template('campaign.html').render(
        summary=summary,
        campaign=plan.campaign,
        style=style.get_source(environment, 'style.css')[0],
        shown=SHOWN,
        points=_POINTS,
        sections=sections,
        settings=yaml.safe_dump(plan.campaign.to_mapping(), sort_keys=False, width=100),
    )
