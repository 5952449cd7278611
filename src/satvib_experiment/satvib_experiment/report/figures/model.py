# SPDX-FileCopyrightText: 2026 The satvib authors
# SPDX-License-Identifier: Apache-2.0
"""Plant output against model output: the paper's Figs. 5 and 10."""

from pathlib import Path

import numpy as np
from satvib_common.struts.names import strut_label

from satvib_experiment.report.context import Context
from satvib_experiment.report.models import final_model, fit, identify_record
from satvib_experiment.report.style import FAINT, MEASURED, MODEL, figure, legend

CAPTION = (
    'Plant output against model output while identifying, the paper’s Figs. 5 and 10: the measured '
    'acceleration, and the model running freely on the voltage alone with the parameters it had at '
    'the end. The fit is 1 - |y - ŷ| / |y - mean y|.'
)
_SHOWN = 1.5  # s


def draw(context: Context, path: Path) -> bool:
    """Draw the figure; False when the run identified nothing."""
    models = [final_model(context, i) for i in range(len(context.struts))]
    records = [identify_record(context, i) for i in range(len(context.struts))]
    if all(m is None for m in models) or all(r is None for r in records):
        return False
    with figure(path, len(models), sharex=True, title=context.recording.title) as (drawn, axes):
        for i, name in enumerate(context.struts):
            ax, model, record = axes[i, 0], models[i], records[i]
            ax.set_ylabel(f'{strut_label(name)}\nm/s²')
            if model is None or record is None:
                continue
            time, measured, voltage = record
            modelled = np.asarray(model.simulate(voltage))
            late = time >= time[-1] - _SHOWN
            ax.plot(
                time[late], (measured - modelled)[late], color=FAINT, lw=0.7, label='difference'
            )
            ax.plot(time[late], measured[late], 'o', ms=2.5, color=MEASURED, label='measured')
            ax.plot(time[late], modelled[late], color=MODEL, label='model, free run')
            ax.set_title(f'fit {fit(measured, modelled):.3f}', fontsize=9)
        axes[-1, 0].set_xlabel('time [s]')
        legend(drawn, axes[:, 0])
    return True
