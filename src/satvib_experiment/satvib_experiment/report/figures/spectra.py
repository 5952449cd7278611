# SPDX-FileCopyrightText: 2026 The satvib authors
# SPDX-License-Identifier: Apache-2.0
"""Spectra of the payload's acceleration before and under control, as measured and true."""

from pathlib import Path
from typing import Any

import numpy as np
from satvib_common.arrays import Array
from satvib_common.struts.names import strut_label

from satvib_experiment.analysis.levels import spectrum
from satvib_experiment.recording.signals import fine, without_bias
from satvib_experiment.report.context import Context
from satvib_experiment.report.style import FAINT, MEASURED, OPEN, TRUE, figure, legend

CAPTION = (
    'Amplitude spectral density of the upper acceleration without control (grey) and under control. '
    'Left: the loop’s own samples, which end at half the sample rate, with the level of the sensor '
    'noise. Right: the truth on the fine grid, with the images that a staircase of voltage makes '
    'above half the sample rate (dashed line).'
)
_LOWEST = 1.0  # Hz
_HIGHEST = 500.0
_RESOLUTION = 0.5


def draw(context: Context, path: Path) -> bool:
    """Draw the figure; False when the run has no window to look at."""
    recording, windows = context.recording, context.evaluation.windows
    if windows.controlled is None:
        return False
    on = recording.window(*windows.controlled)
    baseline, off = recording, on
    if windows.uncontrolled is not None:
        off = recording.window(*windows.uncontrolled)
    elif context.open_loop is not None:
        baseline = context.open_loop
    columns = 2 if context.has_truth else 1
    dt = recording.sample_period
    with figure(
        path, len(context.struts), columns, size=(5.6 * columns, 2.0 * len(context.struts) + 0.9),
        sharex='col', sharey='row', title=context.recording.title,
    ) as (drawn, axes):  # fmt: skip
        for i, name in enumerate(context.struts):
            ax = axes[i, 0]
            _lines(ax, without_bias(baseline, off)[:, i], dt, OPEN, 'control off')
            _lines(ax, without_bias(recording, on)[:, i], dt, MEASURED, 'control on, measured')
            density = context.evaluation.noise * np.sqrt(2.0 * dt)
            if np.isfinite(density) and density > 0:
                ax.axhline(density, color=FAINT, ls=':', lw=1.0, label='sensor noise')
            _limit(ax, context, i, on, off)
            ax.set_ylabel(f'{strut_label(name)}\nm/s²/√Hz')
            if columns == 2:
                ax = axes[i, 1]
                h = recording.fine_period
                _lines(ax, fine(baseline, off)[:, i], h, OPEN, 'control off')
                _lines(ax, fine(recording, on)[:, i], h, TRUE, 'control on, true')
                ax.axvline(0.5 / dt, color=FAINT, ls='--', lw=0.9)
        for ax in axes[-1]:
            ax.set_xlabel('frequency [Hz]')
        axes[0, 0].set_title('measured')
        axes[0, 0].set_xlim(_LOWEST, 0.5 / dt)
        if columns == 2:
            axes[0, 1].set_title('true')
            axes[0, 1].set_xlim(_LOWEST, _HIGHEST)
        legend(drawn, axes[0])
    return True


def _limit(ax: Any, context: Context, i: int, on: slice, off: slice) -> None:
    """Show what counts: from well below the sensor noise to above the highest line."""
    dt = context.recording.sample_period
    peaks = [
        float(np.max(spectrum(without_bias(context.recording, w)[:, i], dt, _RESOLUTION)[1]))
        for w in (on, off)
    ]
    noise = context.evaluation.noise * np.sqrt(2.0 * dt)
    if not max(peaks) > 0.0:  # nothing was measured at this strut
        return
    bottom = noise if np.isfinite(noise) and noise > 0 else 1e-4 * max(peaks)
    ax.set_ylim(0.003 * min(bottom, 0.1 * max(peaks)), 4.0 * max(peaks))


def _lines(ax: Any, signal: Array, dt: float, color: str, label: str) -> None:
    f, density = spectrum(signal, dt, _RESOLUTION)
    keep = f > 0
    ax.loglog(f[keep], np.maximum(density[keep], 1e-12), color=color, lw=1.1, label=label)
