# SPDX-FileCopyrightText: 2026 The satvib authors
# SPDX-License-Identifier: Apache-2.0
"""Voltages that the guards let through."""

from pathlib import Path

import numpy as np
from satvib_common.errors import SatvibError
from satvib_common.levels import largest_known
from satvib_common.struts.names import strut_label

from satvib_experiment.report.context import Context
from satvib_experiment.report.style import INK, MEASURED, STRUTS, figure, shade_phases

CAPTION = (
    'Voltage at each coil as the guard let it through; marked where the guard changed what the law '
    'asked for. Dashed: the limit.'
)


def draw(context: Context, path: Path) -> bool:
    """Draw the figure; False when no voltage was recorded."""
    recording = context.recording
    if not recording.has('voltage'):
        return False
    voltage = recording.get('voltage', 'voltage')
    if not np.any(np.isfinite(voltage)):
        return False
    saturated = recording.get('voltage', 'saturated')
    limit = _limit(context)
    with figure(
        path, len(context.struts), sharex=True, sharey=True, title=context.recording.title
    ) as (_, axes):
        for i, name in enumerate(context.struts):
            ax = axes[i, 0]
            ax.plot(recording.time, voltage[:, i], color=STRUTS[i % 6], lw=0.8)
            ax.plot(
                recording.time[saturated[:, i]], voltage[saturated[:, i], i], '.', ms=3,
                color=MEASURED,
            )  # fmt: skip
            if limit is not None and largest_known(voltage) > 0.6 * limit:
                for sign in (-1, 1):
                    ax.axhline(sign * limit, color=INK, ls='--', lw=0.8)
            ax.set_xlim(0.0, float(recording.time[-1]) + recording.sample_period)
            ax.set_ylabel(f'{strut_label(name)}\nV')
            shade_phases(ax, recording, names=i == 0)
        axes[-1, 0].set_xlabel('time [s]')
    return True


def _limit(context: Context) -> float | None:
    """Voltage limit of the run, V; None when it is not known."""
    scenario = context.recording.scenario
    if scenario is None:
        return None
    rate = 1.0 / context.recording.sample_period
    try:
        parameters = scenario.controller_parameters(rate, struts=len(context.struts))
    except SatvibError:  # a law of one's own that is not here
        return None
    return parameters.voltage_limit
