# SPDX-FileCopyrightText: 2026 The satvib authors
# SPDX-License-Identifier: Apache-2.0
"""Line of sight: the tilt of the payload over time and by frequency, without and under control."""

from pathlib import Path
from typing import Any

import numpy as np
from satvib_common.arrays import Array

from satvib_experiment.analysis.bands import cumulative_rms, integrated, power_lines
from satvib_experiment.analysis.line_of_sight import ARC_SECONDS, tilt_matrix, true_tilt
from satvib_experiment.report.context import Context
from satvib_experiment.report.judged import stretch
from satvib_experiment.report.style import (
    MEASURED,
    OPEN,
    STRUTS,
    TRUE,
    envelope,
    figure,
    legend,
    log_scale,
    plain_ticks,
)

CAPTION = (
    'Tilt of the payload in arc seconds. Left: about x and y over the whole run, from the strokes of the struts; the '
    'scale is that of the stretches that are judged. Right: '
    'RMS of both axes at and above a frequency: true (from the strokes) and measured (the upper accelerations '
    'integrated twice; below some frequency that is sensor noise), without control (grey) and under control.'
)
_LOWEST = 0.5  # Hz


def draw(context: Context, path: Path) -> bool:
    """Draw the figure; False for a payload that does not tilt, or whose strokes are not known."""
    tilt = true_tilt(context.recording)
    if tilt is None:
        return False
    recording = context.recording
    baseline = 'uncontrolled' if stretch(context, 'uncontrolled') else 'open_loop'
    with figure(
        path, 1, 2, size=(11.0, 3.6), width_ratios=(1.5, 1), title=context.recording.title
    ) as (drawn, axes):
        left, right = axes[0]
        for axis, name in enumerate('xy'):
            envelope(
                left, recording.time, ARC_SECONDS * tilt[:, axis], filled=True, bins=400,
                color=STRUTS[axis], alpha=0.7, label=f'about {name}',
            )  # fmt: skip
        left.set_xlim(float(recording.time[0]), float(recording.time[-1]))
        left.set_xlabel('time [s]')
        left.set_ylabel('arc seconds')
        left.set_ylim(*_limits(context, baseline, tilt))
        for name, color in ((baseline, OPEN), ('controlled', TRUE)):
            _cumulative(context, right, name, color)
        right.set_xscale('log')
        log_scale(right, 5.0)
        right.set_xlim(_LOWEST, 0.5 / recording.sample_period)
        right.set_xlabel('above this frequency [Hz]')
        right.set_ylabel('arc seconds RMS')
        plain_ticks([right])
        legend(drawn, axes[0])
    return True


def _limits(context: Context, baseline: str, tilt: Array) -> tuple[float, float]:
    """Limits of the tilt, arc seconds: those of the stretches that are judged; IDENTIFY may be far above them."""
    spans = [found for name in (baseline, 'controlled') if (found := stretch(context, name))]
    parts = [tilt[record.window(*span)] for record, span in spans if record is context.recording]
    most = max((float(np.abs(part).max()) for part in parts if len(part)), default=0.0)
    largest = ARC_SECONDS * (most or float(np.abs(tilt).max()) or 1.0)
    return -1.2 * largest, 1.2 * largest


def _cumulative(context: Context, ax: Any, name: str, color: str) -> None:
    found = stretch(context, name)
    if found is None:
        return
    recording, span = found
    window, dt = recording.window(*span), recording.sample_period
    tilt, matrix = true_tilt(recording, window), tilt_matrix(recording.rig)
    on = name == 'controlled'
    words = 'control on' if on else 'control off'
    if tilt is not None:
        f, power = power_lines(tilt, dt)
        total = cumulative_rms(power.sum(axis=-1))
        # the measured one lies on it, where there is more than noise
        ax.plot(f, ARC_SECONDS * total, color=color, lw=2.6, alpha=0.6, label=f'{words}, true')
    if matrix is not None and on:
        upper = np.nan_to_num(recording.get('acceleration', 'upper')[window])
        f, power = power_lines(upper @ matrix.T, dt)
        total = cumulative_rms(integrated(f, power, 2).sum(axis=-1))
        ax.plot(f, ARC_SECONDS * total, color=MEASURED, lw=1.0, ls='--', label=f'{words}, measured')
