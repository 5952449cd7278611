# SPDX-FileCopyrightText: 2026 The satvib authors
# SPDX-License-Identifier: Apache-2.0
"""Frequency response of the identified models against that of the simulated rig, latency, hold and filter included."""

from pathlib import Path

import numpy as np
from satvib_common.struts.names import strut_label

from satvib_experiment.report.context import Context
from satvib_experiment.report.models import final_model, response_errors, true_response
from satvib_experiment.report.style import FAINT, INK, MODEL, figure, legend, plain_ticks

CAPTION = (
    'Frequency response from voltage to measured acceleration: the identified model and the exact '
    'sampled response of the simulated rig, with latency, hold and filter in both. Whatever a law '
    'computes from the model is off by the difference; the titles give it at the tones.'
)
_LOWEST = 1.0  # Hz


def draw(context: Context, path: Path) -> bool:
    """Draw the figure; False when there is no model or the rig is not known."""
    count = len(context.struts)
    models = [final_model(context, i) for i in range(count)]
    if context.recording.rig is None or all(m is None for m in models):
        return False
    nyquist = 0.5 / context.recording.sample_period
    f = np.geomspace(_LOWEST, 0.98 * nyquist, 200)
    with figure(
        path, 2, count, size=(3.7 * count + 0.6, 5.2), sharex=True, sharey='row',
        title=context.recording.title,
    ) as (drawn, axes):  # fmt: skip
        for i, (name, model) in enumerate(zip(context.struts, models, strict=True)):
            rig = true_response(context, i, f)
            phase = np.unwrap(np.angle(rig))
            style = {'color': INK, 'ls': '--', 'lw': 1.0, 'zorder': 3, 'label': 'rig'}
            axes[0, i].loglog(f, np.abs(rig), **style)
            axes[1, i].semilogx(f, np.degrees(phase), **style)
            if model is not None:
                found = model.frequency_response(f)
                # on the same branch of the angle as the rig's
                difference = np.unwrap(np.angle(found / rig))
                style = {'color': MODEL, 'lw': 2.4, 'alpha': 0.7, 'label': 'identified model'}
                axes[0, i].loglog(f, np.abs(found), **style)
                axes[1, i].semilogx(f, np.degrees(phase + difference), **style)
            for tone in context.evaluation.frequencies:
                for ax in axes[:, i]:
                    ax.axvline(tone, color=FAINT, ls=':', lw=1.0)
            axes[0, i].set_title(_title(context, i, strut_label(name)), fontsize=9)
            axes[1, i].set_xlabel('frequency [Hz]')
        axes[0, 0].set_ylabel('m/s²/V')
        axes[1, 0].set_ylabel('degrees')
        axes[0, 0].set_xlim(_LOWEST, nyquist)
        plain_ticks(axes.ravel())
        legend(drawn, axes[0])
    return True


def _title(context: Context, strut_index: int, label: str) -> str:
    errors = response_errors(context, strut_index)
    shown = [
        f'{e["phase"]:+.0f}° {e["magnitude"]:+.1f} dB at {e["frequency"]:g} Hz' for e in errors
    ]
    return f'{label}: {", ".join(shown)}' if shown else label
