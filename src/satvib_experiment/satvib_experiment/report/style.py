# SPDX-FileCopyrightText: 2026 The satvib authors
# SPDX-License-Identifier: Apache-2.0
"""One look for every figure: colours for colour-blind readers too, and the meaning of each."""

from collections.abc import Iterable, Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any

import matplotlib as mpl
import numpy as np
from matplotlib.axes import Axes
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.figure import Figure
from matplotlib.ticker import FuncFormatter, LogLocator, NullLocator
from numpy.typing import NDArray
from satvib_common.phases import Phase

from satvib_experiment.recording.recording import Recording
from satvib_experiment.report.palette import STRUTS as STRUTS

OPEN = '#8C8C8C'  # without control
TRUE = '#0072B2'  # what really happened
MEASURED = '#D55E00'  # what the loop's samples say
MODEL = '#009E73'
INK = '#222222'
FAINT = '#666666'

_PHASE_SHADE = {
    Phase.CALIBRATE: '#F4F1E6',
    Phase.IDENTIFY: '#E3EEF6',
    Phase.ADAPT: '#E2F2EA',
    Phase.STANDBY: '#F2F2F2',
    Phase.CONTROL: '#FFFFFF',
}
G = 9.80665  # m/s^2

_RC: dict[str, Any] = {
    'font.family': 'DejaVu Sans',
    'font.size': 9.5,
    'axes.titlesize': 10.5,
    'axes.titleweight': 'bold',
    'axes.titlelocation': 'left',
    'axes.labelcolor': INK,
    'axes.edgecolor': '#999999',
    'axes.linewidth': 0.8,
    'axes.spines.top': False,
    'axes.spines.right': False,
    'axes.grid': True,
    'axes.axisbelow': True,
    'grid.color': '#DDDDDD',
    'grid.linewidth': 0.6,
    'xtick.color': FAINT,
    'ytick.color': FAINT,
    'legend.frameon': True,
    'legend.framealpha': 0.9,
    'legend.edgecolor': 'none',
    'legend.fontsize': 8.5,
    'lines.linewidth': 1.3,
    'figure.dpi': 150,
    'figure.constrained_layout.use': True,
    'path.simplify_threshold': 0.5,
    'agg.path.chunksize': 20000,
}


@contextmanager
def figure(path: Path, rows: int, columns: int = 1, **options: Any) -> Iterator[tuple[Figure, Any]]:
    """Give a figure and its axes (rows, columns), and save it to `path` afterwards.

    Args:
        path: the PNG file.
        rows, columns: of axes.
        options: for `Figure.subplots`; `size` is the figure's in inches, `title` stands above it.
    """
    size = options.pop('size', (9.0, 1.9 * rows + 0.6))
    title = options.pop('title', '')
    with mpl.rc_context(_RC):  # type: ignore[arg-type]
        drawn = Figure(figsize=size)
        canvas = FigureCanvasAgg(drawn)
        if title:
            drawn.suptitle(title, x=0.01, ha='left', fontsize=9, color=FAINT)
        yield drawn, drawn.subplots(rows, columns, squeeze=False, **options)
        # `savefig` lays out and draws twice, once to see how large it becomes
        canvas.print_png(path)  # type: ignore[no-untyped-call]


def plain_ticks(axes: Iterable[Axes]) -> None:
    """Frequencies as plain numbers, at 1, 2 and 5 of each decade, and nothing between: each tick costs 3 ms."""
    for ax in axes:
        ax.xaxis.set_major_locator(LogLocator(subs=(1.0, 2.0, 5.0)))
        ax.xaxis.set_major_formatter(FuncFormatter(lambda value, _: f'{value:g}'))
        ax.xaxis.set_minor_locator(NullLocator())


def legend(drawn: Figure, axes: Iterable[Axes], columns: int = 6) -> None:
    """One legend below the figure with what is drawn in any of the axes, each label once."""
    found: dict[str, Any] = {}
    for ax in axes:
        for handle, label in zip(*ax.get_legend_handles_labels(), strict=True):
            found.setdefault(label, handle)
    drawn.legend(list(found.values()), list(found), loc='outside lower center', ncols=columns)


def log_scale(axes: Axes, decades: float) -> None:
    """Make the y axis logarithmic, with so many decades below the largest value: numerical zero is no figure."""
    values = [np.asarray(line.get_ydata(), dtype=float) for line in axes.get_lines()]
    top = max((float(np.nanmax(v)) for v in values if np.any(v > 0.0)), default=0.0)
    if top > 0.0:
        axes.set_yscale('log')
        # ticks between decades say nothing here, and each costs 3 ms
        axes.yaxis.set_minor_locator(NullLocator())
        axes.set_ylim(top * 10.0**-decades, 3.0 * top)


def shade_phases(axes: Axes, recording: Recording, names: bool = False) -> None:
    """Shade the phases behind a plot over time; with `names` written along its top."""
    low, high = axes.get_xlim()
    for phase, start, end in recording.phases():
        start, end = max(start, low), min(end, high)
        if end <= start:
            continue
        axes.axvspan(start, end, color=_PHASE_SHADE[phase], zorder=-5, lw=0)
        axes.axvline(start, color='#BBBBBB', lw=0.7, zorder=-4)
        if names:
            axes.text(
                (start + end) / 2, 1.02, phase.name.lower(), transform=axes.get_xaxis_transform(),
                ha='center', va='bottom', fontsize=7.5, color=FAINT,
                rotation=0 if (end - start) > 0.09 * (high - low) else 35,
            )  # fmt: skip


def g_axis(axes: Axes) -> None:
    """Show g on a second axis on the right; the plot is in m/s^2."""
    second = axes.secondary_yaxis('right', functions=(_to_g, _from_g))
    second.set_ylabel('g', color=FAINT, rotation=0, labelpad=8)
    second.tick_params(colors=FAINT, labelsize=8)
    second.spines['right'].set_visible(True)


def _to_g(value: Any) -> Any:
    return value / G


def _from_g(value: Any) -> Any:
    return value * G


def envelope(
    axes: Axes,
    time: NDArray[Any],
    signal: NDArray[Any],
    filled: bool,
    bins: int = 400,
    **style: Any,
) -> None:
    """Draw a long signal by its least and largest value in each of `bins` stretches, so that nothing is skipped.

    Filled it is a band, otherwise its two outlines; a short signal is drawn as it is.
    """
    if len(signal) <= 2 * bins:
        axes.plot(time, signal, **style)
        return
    edges = np.linspace(0, len(signal), bins + 1).astype(int)[:-1]
    low, high = np.fmin.reduceat(signal, edges), np.fmax.reduceat(signal, edges)
    if filled:
        axes.fill_between(time[edges], low, high, lw=0, step='post', **style)
    else:
        label = style.pop('label', None)
        axes.step(time[edges], high, where='post', label=label, **style)
        axes.step(time[edges], low, where='post', **style)
