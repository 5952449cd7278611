# SPDX-FileCopyrightText: 2026 The satvib authors
# SPDX-License-Identifier: Apache-2.0
"""Figures of the simulation study: the paper's Figs. 3-5, and one over all signals."""

from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np
from satvib_common.errors import SatvibError
from satvib_ident.models.iir_model import IirModel
from satvib_ident.offline.plots import new_figure

from satvib_studies.signal_study.first_order import FirstOrderResult, run_first_order
from satvib_studies.signal_study.study import CASES, NAMES, StudyResult, make_signal

if TYPE_CHECKING:
    from matplotlib.figure import Figure


def _parameters(result: StudyResult, indices: tuple[int, ...], case: str) -> 'Figure':
    figure, axes = new_figure(len(indices), 1, (8.0, 2.2 * len(indices) + 0.6))
    t = np.arange(len(result.rows[0].trace)) / result.settings.sample_rate
    for axis, i in zip(axes[:, 0], indices, strict=True):
        true = float(result.plant.theta[i])
        axis.axhline(true, color='0.2', lw=1.2, label='true')
        for name in result.settings.signals:
            axis.plot(t, result.row(name, case).trace[:, i], lw=0.9, label=name)
        reach = 1.0 if i < 2 else 0.15
        axis.set_ylim(true - reach, true + reach)
        axis.set_ylabel(NAMES[i])
    axes[0, 0].set_title(f'noise and disturbance: {case}; first seed', fontsize=9)
    figure.legend(
        *axes[0, 0].get_legend_handles_labels(), fontsize=7, ncols=9, loc='outside upper center'
    )
    axes[-1, 0].set_xlabel('time [s]')
    return figure


def figure_3(result: StudyResult, case: str = 'both') -> 'Figure':
    """a1 and a2 over time for every signal."""
    return _parameters(result, (0, 1), case)


def figure_4(result: StudyResult, case: str = 'both') -> 'Figure':
    """b1, b2 and b3 over time for every signal."""
    return _parameters(result, (2, 3, 4), case)


def figure_5(result: StudyResult, case: str = 'both') -> 'Figure':
    """Outputs of the plant and of each identified model, free running, last half.

    Left: on the signal that identified it, where even a wrong model fits. Right: on a PRBS, where they differ.
    """
    names = result.settings.signals
    figure, axes = new_figure(len(names), 2, (10.0, 1.1 * len(names) + 0.8))
    count = len(result.rows[0].trace)
    t = np.arange(count) / result.settings.sample_rate
    last = slice(count // 2, count)
    for row, name in enumerate(names):
        theta = result.row(name, case).trace[-1]
        model = IirModel(theta[:2], theta[2:], 0, result.plant.dt)
        for column, signal in enumerate((name, 'PRBS')):
            axis = axes[row, column]
            u = make_signal(signal, result.settings).samples(count)
            true = result.plant.simulate(u)[last]
            axis.plot(t[last], true, color='0.2', lw=1.4)
            reach = 1.3 * float(np.max(np.abs(true)))
            if bool(model.is_stable()):
                axis.plot(t[last], model.simulate(u)[last], color='C3', lw=0.9)
            else:
                axis.text(0.5, 0.5, 'model unstable', transform=axis.transAxes, color='C3')
            axis.set_ylim(-reach, reach)
            axis.tick_params(labelsize=7)
        axes[row, 0].set_ylabel(name, fontsize=8)
    axes[0, 0].set_title('on the signal that identified it', fontsize=9)
    axes[0, 1].set_title('on a PRBS', fontsize=9)
    for axis in axes[-1]:
        axis.set_xlabel('time [s]')
    figure.suptitle('plant (dark) and identified model (red), without disturbance', fontsize=9)
    return figure


def error_figure(result: StudyResult) -> 'Figure':
    """Root mean square error of a1 for every signal and case."""
    figure, ((axis,),) = new_figure(1, 1, (8.0, 3.6))
    names = result.settings.signals
    for j, case in enumerate(CASES):
        heights = [min(max(result.row(name, case).rms[0], 1e-5), 10.0) for name in names]
        axis.bar(np.arange(len(names)) + 0.2 * (j - 1.5), heights, 0.19, label=case)
    axis.set_xticks(np.arange(len(names)), names, fontsize=8)
    axis.set_yscale('log')
    axis.set_ylabel(f'RMS error of a1 over {result.settings.seeds} seeds')
    figure.legend(fontsize=8, ncols=4, loc='outside upper center')
    return figure


def first_order_figure(result: FirstOrderResult) -> 'Figure':
    """The paper's first-order example: a_p and k_p over time for each continuous-time estimator."""
    figure, axes = new_figure(2, 1, (8.0, 4.6))
    for i, name in enumerate(('a_p [1/s]', 'k_p')):
        axis = axes[i, 0]
        axis.axhline(float(result.true[i]), color='0.2', lw=1.2, label='true')
        for label, trace in result.traces.items():
            axis.plot(result.time, trace[:, i], lw=0.9, label=label)
        axis.set_ylabel(name)
        axis.set_ylim(-0.5, 2.0 * float(result.true[i]))
    axes[0, 0].legend(fontsize=7, ncols=3)
    axes[-1, 0].set_xlabel('time [s]')
    return figure


FIGURES = {'figure_3': figure_3, 'figure_4': figure_4, 'figure_5': figure_5, 'errors': error_figure}


def save_figures(result: StudyResult, folder: Path) -> list[Path]:
    """Draw all figures, that of the first-order example too, as study_*.png; never over an existing file.

    Raises:
        SatvibError: a file exists already, or the folder cannot be written.
    """
    paths = {name: folder / f'study_{name}.png' for name in (*FIGURES, 'first_order')}
    for path in paths.values():
        if path.exists():
            raise SatvibError(f'{path}: exists already, not overwritten')
    try:
        folder.mkdir(parents=True, exist_ok=True)
        for name, draw in FIGURES.items():
            draw(result).savefig(paths[name], dpi=130)
        first_order_figure(run_first_order()).savefig(paths['first_order'], dpi=130)
    except OSError as error:
        raise SatvibError(f'{folder}: cannot be written: {error.strerror}') from None
    return list(paths.values())
