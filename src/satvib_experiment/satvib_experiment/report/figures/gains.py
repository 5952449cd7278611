# SPDX-FileCopyrightText: 2026 The satvib authors
# SPDX-License-Identifier: Apache-2.0
"""What the laws adapted: gains inside their proven interval, filter weights, tracked frequency."""

from pathlib import Path

import numpy as np
from satvib_common.struts.names import strut_label

from satvib_experiment.recording.recording import Recording
from satvib_experiment.report.context import Context
from satvib_experiment.report.style import STRUTS, figure, legend, shade_phases

CAPTION = (
    'What the laws adapted. The dotted lines are the interval of the gain that the identified model '
    'proves stable with the modulus margin.'
)
_QUANTITIES = {
    'ki': 'gain $K_i$\nV/(m/s)',
    'kp': 'gain $K_p$\nV/(m/s²)',
    'kd': 'gain $K_d$\nV/(m/s³)',
    'weight_norm': 'weights, norm\nV/(m/s²)',
    'frequency': 'tracked\nfrequency Hz',
}


def shown_quantities(recording: Recording) -> list[str]:
    """Names of the fields that the law uses at all; a gain that stays zero is not shown."""
    if not recording.has('state'):
        return []
    return [
        name
        for name in _QUANTITIES
        if recording.has('state', name) and np.any(np.nan_to_num(recording.get('state', name)))
    ]


def draw(context: Context, path: Path) -> bool:
    """Draw the figure; False when the law has nothing to show."""
    recording = context.recording
    names = shown_quantities(recording)
    if not names:
        return False
    with figure(
        path, len(names), sharex=True, size=(9.0, 2.2 * len(names) + 0.8),
        title=context.recording.title,
    ) as (drawn, axes):  # fmt: skip
        for row, quantity in enumerate(names):
            ax = axes[row, 0]
            values = recording.get('state', quantity)
            for i, name in enumerate(context.struts):
                color = STRUTS[i % 6]
                ax.plot(recording.time, values[:, i], color=color, label=strut_label(name))
                if quantity == 'ki':
                    for bound in ('ki_min', 'ki_max'):
                        ax.plot(
                            recording.time, recording.get('state', bound)[:, i], color=color,
                            ls=':', lw=1.0,
                        )  # fmt: skip
            ax.set_xlim(0.0, float(recording.time[-1]) + recording.sample_period)
            ax.set_ylabel(_QUANTITIES[quantity])
            shade_phases(ax, recording, names=row == 0)
        axes[-1, 0].set_xlabel('time [s]')
        legend(drawn, axes[:, 0])
    return True
