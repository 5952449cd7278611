# SPDX-FileCopyrightText: 2026 The satvib authors
# SPDX-License-Identifier: Apache-2.0
"""Identified parameters over time: the paper's Fig. 8."""

from pathlib import Path
from typing import Any

import numpy as np
from matplotlib.axes import Axes
from satvib_common.arrays import Array
from satvib_common.struts.names import strut_label

from satvib_experiment.report.context import Context
from satvib_experiment.report.models import trust_limits
from satvib_experiment.report.style import INK, STRUTS, figure, legend, shade_phases
from satvib_experiment.twin.noise_free import perfect_parameters

CAPTION = (
    'Parameters of the identified models (Eq. 30) over time, the paper’s Fig. 8. The band is one '
    'standard deviation either way as the estimator states it. Dashed: what the same estimator finds '
    'from the same excitation with perfect sensors. Below: the two figures that decide about trust, '
    'with their limits (dashed).'
)
_TRUST_LABELS = {'response_deviation': 'response\ndeviation', 'model_error': 'model\nerror'}


def draw(context: Context, path: Path) -> bool:
    """Draw the figure; False when the run has no models."""
    recording = context.recording
    if not recording.has('model', 'a'):
        return False
    a, b = recording.get('model', 'a'), recording.get('model', 'b')
    values = np.concatenate([a, b], axis=2)
    deviation = recording.get('model', 'standard_deviation')
    present = recording.get('model', 'present')
    labels = [f'$a_{i + 1}$' for i in range(a.shape[2])]
    labels += [f'$b_{i + 1}$' for i in range(b.shape[2])]
    rows = len(labels)
    trust = {n: v for n, v in trust_limits(context).items() if recording.has('model', n)}
    used = [k for phase, s, e in recording.phases() if phase.name in {'IDENTIFY', 'ADAPT'}
            for k in (s, e)]  # fmt: skip
    limits = (max(used[0] - 0.3, 0.0), used[-1] + 0.5) if used else None
    perfect = perfect_parameters(recording) if context.open_loop is not None else None
    height = 1.35 * (rows + len(trust)) + 0.8
    with figure(
        path, rows + len(trust), size=(9.0, height), sharex=True, title=context.recording.title
    ) as (drawn, axes):
        for row, label in enumerate(labels):
            ax = axes[row, 0]
            for i, name in enumerate(context.struts):
                on = present[:, i]
                time, value, sd = recording.time[on], values[on, i, row], deviation[on, i, row]
                ax.plot(time, value, color=STRUTS[i % 6], label=strut_label(name))
                ax.fill_between(time, value - sd, value + sd, color=STRUTS[i % 6], alpha=0.15, lw=0)
                if perfect is not None:
                    ax.axhline(perfect[i, row], color=STRUTS[i % 6], ls='--', lw=0.9)
                _fit_view(ax, time, value, limits)
            unit = '' if row < a.shape[2] else '\nm/s²/V'
            ax.set_ylabel(label + unit, rotation=0, ha='right', va='center')
            if limits:
                ax.set_xlim(*limits)
            shade_phases(ax, recording, names=row == 0)
        for ax, (quantity, limit) in zip(axes[rows:, 0], trust.items(), strict=True):
            _draw_trust(ax, context, quantity, limit)
            if limits:
                ax.set_xlim(*limits)
            shade_phases(ax, recording)
        axes[-1, 0].set_xlabel('time [s]')
        legend(drawn, axes[:, 0])
    return True


def _draw_trust(ax: Axes, context: Context, quantity: str, limit: float) -> None:
    """Draw a figure of trust of every strut against its limit; what is far above is cut off."""
    recording = context.recording
    values, present = recording.get('model', quantity), recording.get('model', 'present')
    for i in range(len(context.struts)):
        on = present[:, i]
        ax.plot(recording.time[on], values[on, i], color=STRUTS[i % 6])
    if np.isfinite(limit):
        ax.axhline(limit, color=INK, ls='--', lw=0.9)
        ax.set_ylim(0.0, 3.0 * limit)
    ax.set_ylabel(_TRUST_LABELS[quantity], rotation=0, ha='right', va='center')


def _fit_view(ax: Any, time: Array, value: Array, limits: tuple[float, float] | None) -> None:
    """Choose the vertical range by what stays after the first steps, which may overshoot wildly."""
    if limits is None:
        return
    span = limits[1] - limits[0]
    settled = value[(time > limits[0] + 0.25 * span) & np.isfinite(value)]
    if len(settled) == 0:
        return
    low, high = np.min(settled), np.max(settled)
    margin = 0.35 * (high - low) + 0.02 * max(abs(low), abs(high)) + 1e-9
    old = getattr(ax, 'satvib_range', (np.inf, -np.inf))
    ax.satvib_range = (min(old[0], low - margin), max(old[1], high + margin))
    ax.set_ylim(*ax.satvib_range)
