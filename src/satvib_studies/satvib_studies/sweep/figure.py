# SPDX-FileCopyrightText: 2026 The satvib authors
# SPDX-License-Identifier: Apache-2.0
"""A sweep's figure: measured and true attenuation along one of its axes."""

from collections.abc import Sequence
from pathlib import Path
from typing import Any

from satvib_experiment.report.style import MEASURED, TRUE, figure, legend

from satvib_studies.sweep.sweep import SweepFigure

_KINDS = (('rms', 'RMS dB'), ('tone', 'tone dB'))
_STYLES = (('-', 'o'), ('--', 's'), (':', '^'), ('-.', 'D'))


def draw(rows: Sequence[dict[str, Any]], what: SweepFigure, path: Path) -> bool:
    """Draw the worst strut's attenuation over `what.x`; False when no row is left to draw.

    One column of axes per label of `what.panel`, one line style per label of `what.line`; only rows with the labels
    of `what.fixed`.
    """
    kept = [r for r in rows if all(r['labels'][a] == v for a, v in what.fixed.items())]
    if not kept:
        return False
    panels, lines, xs = (
        list(dict.fromkeys(r['labels'][axis] for r in kept))
        for axis in (what.panel, what.line, what.x)
    )
    with figure(
        path, 2, len(panels), size=(4.4 * len(panels) + 0.6, 6.6), sharex=True, sharey=True
    ) as (drawn, axes):
        for column, panel in enumerate(panels):
            axes[0, column].set_title(f'{what.panel}: {panel}')
            for row, (kind, heading) in enumerate(_KINDS):
                ax = axes[row, column]
                for line, (style, marker) in zip(lines, _STYLES * len(lines), strict=False):
                    mine = [
                        r
                        for r in kept
                        if r['labels'][what.panel] == panel and r['labels'][what.line] == line
                    ]
                    for source, color in (('measured', MEASURED), ('true', TRUE)):
                        # no line through a cell whose law refused to act
                        values = [shown(r, f'{source}_{kind}') for r in mine]
                        ax.plot(
                            [xs.index(r['labels'][what.x]) for r in mine], values, style,
                            color=color, marker=marker, ms=4, label=f'{source}, {line}',
                        )  # fmt: skip
                ax.axhline(0.0, color='#222222', lw=0.8)
                ax.set_xticks(range(len(xs)), xs)
                if column == 0:
                    ax.set_ylabel(heading)
            axes[1, column].set_xlabel(what.x)
        legend(drawn, axes[0, :1], columns=len(lines))
    return True


def shown(row: dict[str, Any], kind: str) -> float:
    """The figure of a cell; NaN where it is not known or its law refused to act."""
    value = row['worst'][kind]
    return float('nan') if value is None or row['reasons'] else value
