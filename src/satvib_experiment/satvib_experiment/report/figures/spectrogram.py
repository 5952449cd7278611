# SPDX-FileCopyrightText: 2026 The satvib authors
# SPDX-License-Identifier: Apache-2.0
"""Spectrogram of the payload's acceleration over the whole run: tones that come and go."""

from pathlib import Path

import numpy as np
from matplotlib import mlab
from satvib_common.levels import decibel

from satvib_experiment.report.context import Context
from satvib_experiment.report.style import figure, shade_phases

CAPTION = (
    'Spectrogram of the upper acceleration as sampled, the mean of the struts: amplitude spectral density over time '
    'and frequency. A tone is a horizontal line; control is where it ends or becomes pale.'
)
_SEGMENT = 1.0  # s
_OVERLAP = 0.75
_SPAN = 70.0  # dB below the largest value


def draw(context: Context, path: Path) -> bool:
    """Draw the figure; False when the run is too short or nothing was measured."""
    recording, dt = context.recording, context.recording.sample_period
    signal = np.nan_to_num(context.measured()).mean(axis=1)
    length = min(round(_SEGMENT / dt), len(signal) // 8)
    if length < 16 or not signal.any():
        return False
    found = mlab.specgram(signal, length, 1.0 / dt, noverlap=round(_OVERLAP * length))
    power, f, t = (np.asarray(part, dtype=float) for part in found)
    level = decibel(np.sqrt(np.maximum(power, 1e-300)))
    top = float(level.max())
    begin = float(recording.time[0])
    with figure(path, 1, size=(9.0, 3.6), title=context.recording.title) as (drawn, axes):
        ax = axes[0, 0]
        ends = (begin + t[0] - 0.5 * (t[1] - t[0]), begin + t[-1] + 0.5 * (t[1] - t[0]), 0.0, f[-1])
        image = ax.imshow(
            level, origin='lower', aspect='auto', extent=ends, vmin=top - _SPAN, vmax=top,
            cmap='cividis', interpolation='nearest',
        )  # fmt: skip
        ax.set_xlim(begin, float(recording.time[-1]) + dt)
        shade_phases(ax, recording, names=True)
        ax.set_xlabel('time [s]')
        ax.set_ylabel('frequency [Hz]')
        ax.grid(visible=False)
        drawn.colorbar(image, ax=ax, label='dB of 1 m/s²/√Hz', pad=0.01)
    return True
