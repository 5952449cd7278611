# SPDX-FileCopyrightText: 2026 The satvib authors
# SPDX-License-Identifier: Apache-2.0
"""The figure of a comparison: the payload's level over time, one panel per case, one line per scheme."""

from __future__ import annotations

import math
from pathlib import Path

import numpy as np
from satvib_experiment.report.style import OPEN as GREY
from satvib_experiment.report.style import STRUTS, figure, legend

from satvib_studies.comparison.cases import OPEN
from satvib_studies.comparison.runs import ComparisonResult

_WINDOW = 0.25  # s


def draw(found: ComparisonResult, path: Path) -> None:
    """Draw the medians over the seeds as lines, best and worst as bands."""
    c = found.comparison
    cases = c.case_list()
    columns = 3
    rows = math.ceil(len(cases) / columns)
    width = max(round(_WINDOW / found.dt), 1)
    names = {OPEN: '0 V', **{k: s.title for k, s in c.scheme_list().items()}}
    colours = dict(zip(names, (GREY, *STRUTS), strict=False))
    with figure(path, rows, columns, size=(11.0, 2.2 * rows + 0.6), sharex=True, sharey=True) as (
        drawn,
        axes,
    ):
        for i, case in enumerate(cases.values()):
            ax = axes[i // columns, i % columns]
            ax.set_title(case.title, fontsize=9)
            for scheme, label in names.items():
                power = found.level[scheme][i]
                count = power.shape[1] // width
                mean = power[:, : count * width].reshape(len(power), count, width).mean(axis=2)
                level = np.sqrt(np.maximum(mean, 1e-12))
                time = (np.arange(count) + 0.5) * width * found.dt
                late = time > min(w[0] for w in c.windows.values()) - 7.0
                ax.fill_between(
                    time[late], level.min(axis=0)[late], level.max(axis=0)[late],
                    color=colours[scheme], alpha=0.25, lw=0,
                )  # fmt: skip
                ax.plot(
                    time[late], np.median(level, axis=0)[late], color=colours[scheme], label=label
                )
            ax.axvline(c.event, color='#BBBBBB', lw=0.8)
            ax.set_yscale('log')
        for ax in axes.ravel()[len(cases) :]:
            ax.set_visible(False)
        for ax in axes[-1]:
            ax.set_xlabel('time in s')
        for ax in axes[:, 0]:
            ax.set_ylabel('payload, m/s² RMS')
        legend(drawn, axes[0, :1], columns=3)
