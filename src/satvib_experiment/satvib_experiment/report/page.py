# SPDX-FileCopyrightText: 2026 The satvib authors
# SPDX-License-Identifier: Apache-2.0
"""The report as one HTML page that needs nothing else: style and figures are inside."""

import base64
import math
from pathlib import Path
from typing import Any

import jinja2
import yaml
from satvib_common.errors import SatvibError
from satvib_common.struts.names import strut_label

from satvib_experiment.analysis.evaluation import KINDS
from satvib_experiment.analysis.line_of_sight import ARC_SECONDS, PERIODS
from satvib_experiment.report.comparison import HOLDS, OF_THE_PAPER, WHY
from satvib_experiment.report.context import Context
from satvib_experiment.report.figures.registry import Drawn
from satvib_experiment.report.models import TRUST
from satvib_experiment.report.zoom import zoom_data

KIND_HEADINGS = {
    'measured_rms': 'RMS, measured',
    'true_rms': 'RMS, true',
    'measured_tone': 'tone, measured',
    'true_tone': 'tone, true',
}
STRETCHES = (
    ('uncontrolled', 'without control'),
    ('controlled', 'under control'),
    ('open_loop', 'open-loop twin, same instants'),
)


def number(value: Any, digits: int = 2, signed: bool = False) -> str:
    """Show a number for people; a dash for what is unknown."""
    if value is None or (isinstance(value, float) and not math.isfinite(value)):
        return '–'
    text = f'{value:+.{digits}f}' if signed else f'{value:.{digits}f}'
    return text.replace('-', '\u2212')


def significant(value: Any, digits: int = 3) -> str:
    """Show a number with so many digits that count; a dash for what is unknown."""
    if value is None or (isinstance(value, float) and not math.isfinite(value)):
        return '–'
    return f'{value:#.{digits}g}'.rstrip('.').replace('-', '\u2212')


def percent(value: Any) -> str:
    """Show a share in percent; a dash for what is unknown."""
    return number(None if value is None else 100.0 * value, 1)


def sight(value: Any, kind: str) -> str:
    """Show an angle of the line of sight in microradians and arc seconds; a dash for what is unknown."""
    angle = (value or {}).get(kind)
    if angle is None:
        return '–'
    return f'{significant(1e6 * angle)} µrad, {significant(ARC_SECONDS * angle)}″'


def write_page(context: Context, result: dict[str, Any], figures: list[Drawn], path: Path) -> None:
    """Write report.html.

    Args:
        context: the run.
        result: what result.json holds.
        figures: as drawn; they are put into the page.
        path: where to.

    Raises:
        SatvibError: the page exists already or cannot be written.
    """
    environment = jinja2.Environment(
        loader=jinja2.PackageLoader('satvib_experiment', 'report'),
        autoescape=True,
        trim_blocks=True,
        lstrip_blocks=True,
        undefined=jinja2.StrictUndefined,
    )
    environment.filters |= {
        'number': number, 'percent': percent, 'significant': significant, 'sight': sight,
        'strut': strut_label,
    }  # fmt: skip
    for name, file in (('style', 'style.css'), ('script', 'zoom.js')):
        environment.globals[name] = environment.loader.get_source(  # type: ignore[union-attr]
            environment, file
        )[0]
    kinds = [k for k in KINDS if any(s['attenuation'][k] is not None for s in result['struts'])]
    text = environment.get_template('page.html').render(
        result=result,
        why=WHY,
        holds=HOLDS,
        of_the_paper=OF_THE_PAPER,
        description=context.recording.scenario.description if context.recording.scenario else '',
        kinds=sorted(kinds, key=lambda k: list(KIND_HEADINGS).index(k)),
        headings=KIND_HEADINGS,
        spans=_spans(result),
        stretches=STRETCHES,
        sight_periods=PERIODS,
        zoom=zoom_data(context),
        parameter_names=_parameter_names(result),
        trust=list(TRUST),
        figures=[(figure, _embedded(figure.path)) for figure in figures],
        settings=_text(result['settings']),
        rig=_text(result['rig']),
    )
    try:
        with path.open('x', encoding='utf-8') as sink:
            sink.write(text)
    except FileExistsError:
        raise SatvibError(f'{path}: exists already, not overwritten') from None
    except OSError as error:
        raise SatvibError(f'{path}: cannot be written: {error.strerror}') from None


def _spans(result: dict[str, Any]) -> list[str]:
    """Sentences on the windows and the tones."""
    found = []
    for name, words in (('uncontrolled', 'Without control'), ('controlled', 'Under control')):
        span = result['windows'][name]
        if span:
            found.append(f'{words}: {span[0]:g} to {span[1]:g} s.')
    tones = ', '.join(f'{f:g}' for f in result['frequencies'])
    if tones:
        found.append(f'Tone{"s" if len(result["frequencies"]) > 1 else ""}: {tones} Hz.')
    return found


def _parameter_names(result: dict[str, Any]) -> list[str]:
    model = next((s['model'] for s in result['struts'] if s['model']), None)
    if model is None:
        return []
    return [f'a{i + 1}' for i in range(len(model['a']))] + [
        f'b{i + 1}' for i in range(len(model['b']))
    ]


def _embedded(path: Path) -> str:
    return 'data:image/png;base64,' + base64.b64encode(path.read_bytes()).decode('ascii')


def _text(mapping: dict[str, Any] | None) -> str:
    if mapping is None:
        return 'not recorded'
    return yaml.safe_dump(mapping, sort_keys=False, default_flow_style=None, width=100)
