# SPDX-FileCopyrightText: 2026 The satvib authors
# SPDX-License-Identifier: Apache-2.0
"""Figures of an offline identification: fit, residual correlations, poles and zeros, Bode.

Matplotlib is imported when a figure is drawn, and only there; no screen is needed.
"""

from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
from satvib_common.arrays import Array, Complex
from satvib_common.errors import SatvibError

from satvib_ident.offline.result import OfflineResult

if TYPE_CHECKING:
    from matplotlib.figure import Figure


def new_figure(rows: int, columns: int, size: tuple[float, float]) -> tuple['Figure', Any]:
    """A figure without a screen and its axes, (rows, columns); size in inches."""
    from matplotlib.backends.backend_agg import FigureCanvasAgg
    from matplotlib.figure import Figure

    figure = Figure(figsize=size, layout='constrained')
    FigureCanvasAgg(figure)
    return figure, figure.subplots(rows, columns, squeeze=False)


def fit_figure(result: OfflineResult) -> 'Figure':
    """Measured output, one-step prediction and free run; below, the one-step error."""
    model, y = result.model, result.y
    t = np.arange(len(y)) * model.dt
    figure, ((above,), (below,)) = new_figure(2, 1, (9.0, 5.5))
    above.plot(t, y, color='0.2', lw=1.2, label='measured')
    above.plot(t, result.predicted, lw=0.9, label=f'one step, fit {result.chosen.one_step:.4f}')
    above.plot(t, result.free, lw=0.9, ls='--', label=f'free run, fit {result.chosen.free_run:.4f}')
    above.axvline(t[result.split], color='0.7', lw=0.8)
    above.annotate(' validation', (t[result.split], np.nanmin(y)), fontsize=8)
    above.set_ylabel('output [m/s²]')
    above.legend(loc='upper right', fontsize=8)
    below.plot(t, result.residual, lw=0.8, color='C0')
    below.set_ylabel('one-step error [m/s²]')
    below.set_xlabel('time [s]')
    above.set_title(result.reason, fontsize=9)
    return figure


def residual_figure(result: OfflineResult) -> 'Figure':
    """Correlations of the residual with itself and with the input, and their 99 % bounds."""
    tests = result.tests
    figure, ((left, right),) = new_figure(1, 2, (9.0, 3.2))
    lags = np.arange(tests.lags + 1)
    left.stem(lags, tests.auto, basefmt=' ', markerfmt='C0.')
    left.set_title(f'residual with itself: p = {tests.p_value:.2g} if it were white', fontsize=9)
    both = np.arange(-tests.lags, tests.lags + 1)
    right.stem(both, tests.cross, basefmt=' ', markerfmt='C0.')
    right.set_title('residual with input', fontsize=9)
    for axis, bound in ((left, tests.auto_bound), (right, tests.cross_bound)):
        axis.axhspan(-bound, bound, color='0.85', zorder=0)
        axis.set_xlabel('lag [samples]')
    return figure


def pole_zero_figure(result: OfflineResult) -> 'Figure':
    """Poles and zeros in the z plane."""
    figure, ((axis,),) = new_figure(1, 1, (4.5, 4.5))
    circle = np.exp(1j * np.linspace(0.0, 2.0 * np.pi, 200))
    axis.plot(circle.real, circle.imag, color='0.7', lw=0.8)
    poles, zeros = result.model.poles(), result.model.zeros()
    zeros = zeros[np.isfinite(zeros)]
    axis.plot(poles.real, poles.imag, 'x', label='poles')
    axis.plot(zeros.real, zeros.imag, 'o', mfc='none', label='zeros')
    axis.set_aspect('equal')
    axis.set(xlim=(-2.0, 2.0), ylim=(-2.0, 2.0))
    far = zeros[np.maximum(np.abs(zeros.real), np.abs(zeros.imag)) > 2.0]
    if far.size:
        where = ', '.join(f'{z.real:.3g}' if z.imag == 0.0 else f'{z:.3g}' for z in far)
        axis.set_title(f'further out, zeros at {where}', fontsize=9)
    axis.set_xlabel('Re z')
    axis.set_ylabel('Im z')
    axis.legend(fontsize=8)
    return figure


def _phase(response: Complex) -> Array:
    """Unwrapped phase, degrees."""
    return np.degrees(np.unwrap(np.angle(response)))


def bode_figure(result: OfflineResult) -> 'Figure':
    """Gain and phase of every candidate, the chosen one in front."""
    figure, ((above,), (below,)) = new_figure(2, 1, (7.0, 5.0))
    nyquist = 0.5 / result.model.dt
    f = np.geomspace(nyquist / 200.0, 0.999 * nyquist, 400)
    own = _phase(result.model.frequency_response(f))
    for candidate in sorted(result.candidates, key=lambda c: c is result.chosen):
        mine = candidate is result.chosen
        g = candidate.model.frequency_response(f)
        style = {'color': 'C3', 'lw': 1.6} if mine else {'color': '0.7', 'lw': 0.8}
        above.loglog(f, np.abs(g), label=candidate.name if mine else None, **style)
        # turns that unwrapping has added or left out would part curves that agree
        phase = _phase(g)
        below.semilogx(f, phase - 360.0 * np.round(np.median(phase - own) / 360.0), **style)
    above.set_ylabel('gain [m/s²/V]')
    below.set_ylabel('phase [°]')
    below.set_xlabel('frequency [Hz]')
    above.legend(fontsize=8)
    return figure


FIGURES = {
    'fit': fit_figure,
    'residual': residual_figure,
    'poles_zeros': pole_zero_figure,
    'bode': bode_figure,
}


def save_plots(result: OfflineResult, folder: Path, prefix: str = 'identify') -> list[Path]:
    """Draw all figures as PNG files into a folder, never over an existing file.

    Returns:
        The files: prefix_fit.png, prefix_residual.png, prefix_poles_zeros.png, prefix_bode.png.

    Raises:
        SatvibError: a file exists already, or the folder cannot be written.
    """
    paths = {name: folder / f'{prefix}_{name}.png' for name in FIGURES}
    for path in paths.values():
        if path.exists():
            raise SatvibError(f'{path}: exists already, not overwritten')
    try:
        folder.mkdir(parents=True, exist_ok=True)
        for name, path in paths.items():
            FIGURES[name](result).savefig(path, dpi=130)
    except OSError as error:
        raise SatvibError(f'{folder}: cannot be written: {error.strerror}') from None
    return list(paths.values())
