# SPDX-FileCopyrightText: 2026 The satvib authors
# SPDX-License-Identifier: Apache-2.0
"""The samples of a run as data of the page, for `zoom.js`: what a reader can zoom into without any network."""

import base64
import json
from typing import Any, NamedTuple

import numpy as np
from satvib_common.arrays import Array
from satvib_common.levels import largest_known
from satvib_common.struts.names import strut_label

from satvib_experiment.report.context import Context
from satvib_experiment.report.palette import STRUTS

MOST = 40_000  # samples of a strut, the last ones; 80 kB each
_GAP = -32768  # a sample that is missing
_FULL = 32767


class Panel(NamedTuple):
    """One panel: name, heading, and label with colour of each line."""

    name: str
    heading: str
    lines: list[tuple[str, str]]


def zoom_data(context: Context) -> tuple[list[Panel], str] | None:
    """Give the panels and their data as JSON; None when nothing was measured."""
    recording = context.recording
    kept = slice(max(len(recording.sequence) - MOST, 0), None)
    signals = {'acceleration': ('Upper acceleration, measured', 'm/s²', context.measured()[kept])}
    if recording.has('voltage', 'voltage'):
        signals['voltage'] = ('Voltage', 'V', recording.get('voltage', 'voltage')[kept])
    found: list[dict[str, Any]] = []
    panels = []
    colors = [STRUTS[i % len(STRUTS)] for i in range(len(context.struts))]
    for name, (heading, unit, values) in signals.items():
        most = float(largest_known(values))
        if not np.isfinite(most):
            continue
        scale = (most or 1.0) / _FULL
        series = [_text(values[:, i], scale) for i in range(values.shape[1])]
        found.append(
            {'name': name, 'unit': unit, 'scale': scale, 'colors': colors, 'series': series}
        )
        labels = [strut_label(strut) for strut in context.struts]
        panels.append(Panel(name, heading, list(zip(labels, colors, strict=True))))
    if not found:
        return None
    about = {
        'start': float(recording.time[kept][0]),
        'period': recording.sample_period,
        'count': len(recording.sequence[kept]),
        'panels': found,
    }
    return panels, json.dumps(about)


def _text(values: Array, scale: float) -> str:
    """Whole numbers of 16 bits, little-endian, as base64."""
    whole = np.where(np.isfinite(values), np.rint(np.nan_to_num(values) / scale), _GAP)
    return base64.b64encode(whole.astype('<i2').tobytes()).decode('ascii')
