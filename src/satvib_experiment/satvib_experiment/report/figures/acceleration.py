# SPDX-FileCopyrightText: 2026 The satvib authors
# SPDX-License-Identifier: Apache-2.0
"""Acceleration of the payload with control off and on: the paper's Fig. 9, and what it could not see."""

from pathlib import Path
from typing import Any

import numpy as np
from satvib_common.arrays import Array
from satvib_common.levels import largest_known
from satvib_common.struts.names import strut_label

from satvib_experiment.recording.signals import fine, without_bias
from satvib_experiment.report.context import Context
from satvib_experiment.report.style import (
    MEASURED,
    OPEN,
    TRUE,
    envelope,
    figure,
    g_axis,
    legend,
    shade_phases,
)

CAPTION = (
    'Acceleration of the upper plate at each strut, the paper’s Fig. 9. Left: the whole run, what '
    'really happened (blue) and what the loop’s samples say (orange), as the span between the least and the largest '
    'value; the axis is cut at 2.5 times what the windows with and without control reach. Right: the end of the '
    'stretch under control, on the fine grid, against the open-loop twin on the same seed (grey); the dots '
    'are the samples, all that the controller sees.'
)
_ZOOM_PERIODS = 4
_ZOOM_SAMPLES = 40
_BIN = 0.25  # s, longer than a period of what there is to see


def draw(context: Context, path: Path) -> bool:
    """Draw the figure; False when nothing was measured."""
    recording, count = context.recording, len(context.struts)
    if not np.any(np.isfinite(recording.get('acceleration', 'upper'))):
        return False
    end = float(recording.time[-1]) + recording.sample_period
    judged = context.evaluation.windows.controlled
    until = judged[1] if judged else end
    lowest = min(context.evaluation.frequencies, default=0.0)
    length = _ZOOM_PERIODS / lowest if lowest else _ZOOM_SAMPLES * recording.sample_period
    zoom = recording.window(max(until - length, 0.0), until)
    measured = context.measured()
    bins = max(round((end - float(recording.time[0])) / _BIN), 60)
    with figure(
        path, count, 2, size=(11.5, 2.1 * count + 0.9), sharex='col', sharey='row',
        width_ratios=(1.6, 1), title=context.recording.title,
    ) as (drawn, axes):  # fmt: skip
        for i, name in enumerate(context.struts):
            left, right = axes[i]
            if context.has_truth:
                envelope(
                    left, context.fine_time(), context.fine()[:, i], filled=True, bins=bins, color=TRUE,
                    alpha=0.75, label='true',
                )  # fmt: skip
            envelope(
                left, recording.time, measured[:, i], filled=False, bins=bins, color=MEASURED, lw=1.0,
                label='measured',
            )  # fmt: skip
            left.set_xlim(0.0, end)
            shade_phases(left, recording, names=i == 0)
            left.set_ylabel(f'{strut_label(name)}\nm/s²')
            _draw_zoom(context, right, i, zoom, measured)
            limit = _limit(context, i, measured)
            left.set_ylim(-limit, limit)
            g_axis(right)
        axes[0, 1].set_title('under control, close up')
        axes[-1, 0].set_xlabel('time [s]')
        axes[-1, 1].set_xlabel('time [s]')
        axes[-1, 1].locator_params(axis='x', nbins=5)
        legend(drawn, (axes[0, 0], axes[0, 1]))
    return True


def _draw_zoom(context: Context, ax: Any, i: int, zoom: slice, measured: Array) -> None:
    recording = context.recording
    if context.open_loop is not None:
        ax.plot(
            context.fine_time(zoom), fine(context.open_loop, zoom)[:, i], color=OPEN, lw=1.1,
            label='open-loop twin',
        )  # fmt: skip
    if context.has_truth:
        ax.plot(context.fine_time(zoom), context.fine(zoom)[:, i], color=TRUE, lw=1.2)
    ax.plot(
        recording.time[zoom], measured[zoom, i], 'o', ms=3.2, color=MEASURED, label='samples',
        zorder=5,
    )  # fmt: skip


def _limit(context: Context, i: int, measured: Array) -> float:
    """Vertical range: all of it, without the odd first kick of the excitation when that is far larger."""
    windows = context.evaluation.windows
    signals = [measured[:, i]]
    if context.has_truth:
        signals.append(context.fine()[:, i])
    largest = _largest(signals)
    inside = 0.0
    for source in (context.recording, context.open_loop):
        for span in (windows.uncontrolled, windows.controlled):
            if source is not None and span is not None:
                window = source.window(*span)
                seen = [without_bias(source, window)[:, i]]
                if source.has('truth', 'upper'):
                    seen.append(fine(source, window)[:, i])
                inside = max(inside, _largest(seen))
    shown = min(largest or inside, 2.5 * inside) if inside else largest
    return 1.1 * (shown or 1.0)


def _largest(signals: list[Array]) -> float:
    """Largest magnitude of some signals; 0 when nothing is known of them."""
    return max(float(np.nan_to_num(largest_known(signal))) for signal in signals)
