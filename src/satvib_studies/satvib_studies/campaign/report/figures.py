# SPDX-FileCopyrightText: 2026 The satvib authors
# SPDX-License-Identifier: Apache-2.0
"""Figures of a campaign: how its figures are spread, what they depend on, and how."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray
from satvib_common.arrays import Array
from satvib_experiment.report.style import FAINT, INK, MEASURED, OPEN, TRUE, figure, legend

from satvib_studies.campaign.measures.sensitivity import Sensitivity, groups_of

SPREAD = (
    'How many trials stay below a value: the worst strut of every trial, as measured by the loop and as it really is. '
    'The dotted lines are the median and the 95 % point of the truth.'
)
SHARE = (
    'Part of the variance of the figure that each parameter explains alone (correlation ratio, corrected for '
    'chance); the sign is that of Spearman’s rank correlation: + where more of the parameter is worse.'
)
SHAPE = (
    'The figure against the parameters that it depends on most: every trial a dot, the line the median of groups '
    'of equal size, the band from 5 % to 95 % of them.'
)
_KINDS = ('rms', 'tone')
_MOST_DOTS = 4000


def draw_spread(figures: dict[str, Array], path: Path) -> bool:
    """Draw the cumulative distributions of the attenuations; False when no trial has any."""
    kinds = [k for k in _KINDS if np.isfinite(figures[f'attenuation_true_{k}']).any()]
    if not kinds:
        return False
    with figure(path, 1, len(kinds), size=(5.4 * len(kinds), 3.6), sharey=True) as (drawn, axes):
        for ax, kind in zip(axes[0], kinds, strict=True):
            for source, color in (('measured', MEASURED), ('true', TRUE)):
                values = figures[f'attenuation_{source}_{kind}']
                values = np.sort(values[np.isfinite(values)])
                share = 100.0 * np.arange(1, len(values) + 1) / max(len(values), 1)
                ax.step(values, share, where='post', color=color, label=source)
            for level in (50.0, 95.0):
                ax.axvline(float(np.percentile(values, level)), color=FAINT, ls=':', lw=0.9)
            ax.axvline(0.0, color=INK, lw=0.8)
            ax.set_xlabel(f'attenuation, {"RMS" if kind == "rms" else "tone"} [dB]')
        axes[0, 0].set_ylabel('trials below [%]')
        axes[0, 0].set_ylim(0.0, 100.0)
        legend(drawn, axes[0])
    return True


def draw_shares(found: Sequence[Sensitivity], judge: str, path: Path) -> bool:
    """Draw the ranking of the parameters; False when there is none."""
    known = [s for s in found if np.isfinite(s.share)][:15]
    if not known:
        return False
    with figure(path, 1, 1, size=(8.0, 0.5 * len(known) + 1.0)) as (_, axes):
        ax = axes[0, 0]
        for row, item in enumerate(known):
            worse = item.rank > 0
            color = OPEN if not np.isfinite(item.rank) else (MEASURED if worse else TRUE)
            ax.barh(row, 100.0 * item.share, color=color, height=0.45)
            sign = '' if not np.isfinite(item.rank) else f'   rank correlation {item.rank:+.2f}'
            shown = f' {item.key}   {100.0 * item.share:.0f} %{sign}'
            ax.text(0.0, row - 0.28, shown, va='bottom', fontsize=8.5)
        ax.set_yticks([])
        ax.set_ylim(-0.9, len(known) - 0.6)
        ax.invert_yaxis()
        ax.set_xlim(0.0, 105.0 * max(max(s.share for s in known), 0.05))
        ax.set_xlabel(f'share of the variance of {judge} [%]')
        ax.grid(axis='y', visible=False)
    return True


def draw_shapes(
    parameters: dict[str, NDArray[Any]], figures: Array, judge: str, keys: Sequence[str], path: Path
) -> bool:
    """Draw the figure over up to six parameters; False when there is nothing to draw."""
    good = np.isfinite(figures)
    keys = keys[:6]
    if not keys or good.sum() < 2:
        return False
    columns = min(len(keys), 3)
    rows = -(-len(keys) // columns)
    with figure(path, rows, columns, size=(3.9 * columns, 2.9 * rows + 0.3), sharey=True) as (
        _, axes,
    ):  # fmt: skip
        for ax in axes.ravel()[len(keys) :]:
            ax.set_visible(False)
        for ax, key in zip(axes.ravel(), keys, strict=False):
            _shape(ax, np.asarray(parameters[key])[good], figures[good])
            ax.set_xlabel(key)
        for ax in axes[:, 0]:
            ax.set_ylabel(judge.replace('_', ' '))
    return True


def _shape(ax: Any, values: NDArray[Any], figures: Array) -> None:
    names = None
    if values.dtype.kind not in 'if':
        names, values = np.unique(values, return_inverse=True)
        ax.set_xticks(range(len(names)), [str(n).strip('"') for n in names])
    few = slice(None, None, max(len(values) // _MOST_DOTS, 1))
    ax.plot(values[few], figures[few], '.', ms=2.0, color=OPEN, alpha=0.6, rasterized=True)
    groups = groups_of(values.tolist())
    x, low, middle, high = [], [], [], []
    for g in range(int(groups.max()) + 1):
        inside = groups == g
        x.append(float(np.median(values[inside])))
        a, b, c = np.percentile(figures[inside], [5.0, 50.0, 95.0])
        low.append(a)
        middle.append(b)
        high.append(c)
    ax.fill_between(x, low, high, color=TRUE, alpha=0.15, lw=0)
    ax.plot(x, middle, 'o-' if len(x) < 10 else '-', ms=4, color=TRUE)
