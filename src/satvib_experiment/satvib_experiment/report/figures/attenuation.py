# SPDX-FileCopyrightText: 2026 The satvib authors
# SPDX-License-Identifier: Apache-2.0
"""Attenuation strut by strut: measured beside true beside the figures to compare with."""

from pathlib import Path

import numpy as np
from satvib_common.struts.names import strut_label

from satvib_experiment.report.context import Context
from satvib_experiment.report.style import FAINT, INK, MEASURED, TRUE, figure, legend

CAPTION = (
    'Attenuation (Eq. 42), negative is better: what the loop’s samples say, and what is true. Left '
    'of the zero line the payload is quieter than without control, right of it louder. The tick is '
    'the figure to compare with; the dotted line is the floor that sensor noise sets for the samples.'
)
_PLATE = {'facecolor': 'white', 'edgecolor': 'none', 'pad': 0.6}
_ROWS = {'rms': 'RMS', 'tone': 'tone'}


def draw(context: Context, path: Path) -> bool:
    """Draw the figure; False when there is no attenuation."""
    e = context.evaluation
    kinds = [k for k in _ROWS if np.any(np.isfinite(e.attenuation[f'measured_{k}']))]
    if not kinds:
        return False
    count = len(context.struts)
    with figure(
        path, 1, len(kinds), size=(5.2 * len(kinds), 0.85 * count + 1.4), sharey=True, sharex=True,
        title=context.recording.title,
    ) as (drawn, axes):  # fmt: skip
        for column, kind in enumerate(kinds):
            ax = axes[0, column]
            rows = np.arange(count)
            for offset, source, color in ((-0.17, 'measured', MEASURED), (0.17, 'true', TRUE)):
                value = e.attenuation[f'{source}_{kind}']
                bars = ax.barh(rows + offset, value, 0.3, color=color, label=source)
                known = [f'{v:+.1f}' if np.isfinite(v) else '' for v in value]
                ax.bar_label(bars, known, padding=3, fontsize=8, color=INK, bbox=_PLATE, zorder=9)
            if len(e.reference) == count and kind == 'tone':
                ax.plot(e.reference, rows, '|', ms=24, mew=2.2, color=INK, label=e.reference_source)
            floor = e.floor[f'measured_{kind}']
            for i in range(count):
                if np.isfinite(floor[i]):
                    label = 'noise floor of the samples' if i == 0 else None
                    ax.plot([floor[i]] * 2, [i - 0.4, i + 0.4], ':', color=FAINT, label=label)
            ax.axvline(0.0, color=INK, lw=0.9)
            ax.set_title(_ROWS[kind])
            ax.set_xlabel('dB')
            ax.set_yticks(rows, [strut_label(n) for n in context.struts])
            ax.set_ylim(count - 0.45, -0.55)
            ax.grid(visible=False, axis='y')
            ax.margins(x=0.14)
        legend(drawn, axes[0, ::-1])
    return True
