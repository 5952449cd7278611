# SPDX-FileCopyrightText: 2026 The satvib authors
# SPDX-License-Identifier: Apache-2.0
"""Figures of measured frequency responses: magnitude, phase and coherence, open, closed and exact."""

from collections.abc import Sequence
from pathlib import Path
from typing import Any

import numpy as np
from satvib_common.levels import decibel
from satvib_common.struts.names import strut_label

from satvib_experiment.frf.curve import OPEN as OPEN_LOOP
from satvib_experiment.frf.curve import PATH, TRANSMISSIBILITY, Curve
from satvib_experiment.frf.modes import MOTION_NAMES
from satvib_experiment.report.style import FAINT, INK, MEASURED, MODEL, OPEN, STRUTS, figure, legend

MOST_COLUMNS = 3


def draw_figures(curves: Sequence[Curve], folder: Path) -> list[Path]:
    """Draw what there is: transmissibility.png, motions.png, paths.png, coupling.png.

    Raises:
        OSError: a file cannot be written.
    """
    moved = [c for c in curves if c.quantity == TRANSMISSIBILITY]
    struts = [c for c in moved if c.output not in MOTION_NAMES]
    motions = [c for c in moved if c.output in MOTION_NAMES]
    paths = [c for c in curves if c.quantity == PATH]
    drawn = []
    for name, chosen, unit in (
        ('transmissibility', struts, 'payload over base [dB]'),
        ('motions', motions, 'payload over base [dB]'),
        ('paths', [c for c in paths if c.output == c.input or len(paths) == 1], 'm/s² per V [dB]'),
    ):
        if chosen:
            drawn.append(folder / f'{name}.png')
            _three_rows(chosen, drawn[-1], unit)
    if len(paths) > 1:
        drawn.append(folder / 'coupling.png')
        _matrix(paths, drawn[-1])
    return drawn


def _colors(curves: Sequence[Curve]) -> dict[str, str]:
    """A colour for each loop: grey for the open one."""
    laws = [name for name in dict.fromkeys(c.loop for c in curves) if name != OPEN_LOOP]
    ordered = [STRUTS[0], MEASURED, STRUTS[2], STRUTS[3], STRUTS[4], STRUTS[5]]
    return {OPEN_LOOP: OPEN, **{law: ordered[i % 6] for i, law in enumerate(laws)}}


def _three_rows(curves: Sequence[Curve], path: Path, unit: str) -> None:
    """Draw a column of magnitude, phase and coherence for each output."""
    outputs = list(dict.fromkeys(c.output for c in curves))
    columns = min(len(outputs), MOST_COLUMNS)
    bands = -(-len(outputs) // columns)
    colors = _colors(curves)
    if curves[0].quantity == PATH:
        colors[OPEN_LOOP] = STRUTS[0]
    with figure(
        path, 3 * bands, columns, size=(3.9 * columns + 1.0, 6.4 * bands), sharex=True,
        height_ratios=(3, 2, 1) * bands,
    ) as (drawn, axes):  # fmt: skip
        for place, output in enumerate(outputs):
            band, column = divmod(place, columns)
            above, middle, below = axes[3 * band : 3 * band + 3, column]
            for curve in (c for c in curves if c.output == output):
                _draw(curve, colors[curve.loop], above, middle, below)
            above.set_title(_label(output))
            above.set_ylim(*_limits([c for c in curves if c.output == output]))
            middle.set_ylim(-190.0, 190.0)
            middle.set_yticks((-180, -90, 0, 90, 180))
            below.set_ylim(0.0, 1.05)
            below.set_xlabel('frequency [Hz]')
            if column == 0:
                above.set_ylabel(unit)
                middle.set_ylabel('phase [°]')
                below.set_ylabel('coherence')
        for row in range(3 * bands):
            for column in range(columns):
                if row // 3 * columns + column >= len(outputs):
                    axes[row, column].set_visible(False)
        axes[0, 0].set_xscale('log')
        axes[0, 0].set_xlim(
            min(c.measured.frequency[0] for c in curves),
            max(c.measured.frequency[-1] for c in curves),
        )
        _plain_ticks(axes.ravel())
        legend(drawn, axes.ravel())


def _draw(curve: Curve, color: str, above: Any, middle: Any, below: Any) -> None:
    m = curve.measured
    low, high = m.band
    above.fill_between(m.frequency, _db(low), _db(high), color=color, alpha=0.25, lw=0)
    above.plot(m.frequency, _db(m.magnitude), color=color, lw=2.2, label=_loop(curve))
    middle.plot(m.frequency, *_broken(np.degrees(np.angle(m.value))), color=color, lw=2.0)
    below.plot(m.frequency, m.coherence, color=color, lw=0.9)
    for other, ink, style, label in (
        (curve.exact, INK, '--', 'exact response of the rig'),
        (curve.model, MODEL, '-.', 'identified model'),
    ):
        if other is not None:
            above.plot(m.frequency, _db(np.abs(other)), color=ink, ls=style, lw=0.8, label=label)
            middle.plot(
                m.frequency, *_broken(np.degrees(np.angle(other))), color=ink, ls=style, lw=0.7
            )
    above.axhline(0.0, color=FAINT, lw=0.6, ls=':')


def _broken(phase: Any) -> tuple[Any]:
    """A phase whose line is broken where it wraps."""
    shown = np.asarray(phase, dtype=float).copy()
    shown[1:][np.abs(np.diff(phase)) > 180.0] = np.nan
    return (shown,)


def _loop(curve: Curve) -> str:
    if curve.quantity == PATH:
        return 'measured'
    return 'open loop' if curve.loop == OPEN_LOOP else curve.loop.replace('_', ' ')


def _label(name: str) -> str:
    return strut_label(name)


def _db(size: Any) -> Any:
    return decibel(np.maximum(size, 1e-12))


def _limits(curves: Sequence[Curve]) -> tuple[float, float]:
    """Limits of an axis in dB: what is measured with some coherence, and what is exact."""
    levels = []
    for curve in curves:
        sure = curve.measured.coherence > 0.3
        levels.append(_db(curve.measured.magnitude)[sure])
        if curve.exact is not None:
            levels.append(_db(np.abs(curve.exact)))
    every = np.concatenate(levels)
    every = every[np.isfinite(every)]
    if not every.size:
        return -60.0, 20.0
    low, high = np.quantile(every, 0.01), every.max()
    return float(low - 6.0), float(high + 4.0)


def _plain_ticks(axes: Any) -> None:
    """Frequencies as plain numbers, at 1, 2 and 5 of each decade."""
    from matplotlib.ticker import FuncFormatter, LogLocator, NullFormatter

    for ax in axes:
        ax.xaxis.set_major_locator(LogLocator(subs=(1.0, 2.0, 5.0)))
        ax.xaxis.set_major_formatter(FuncFormatter(lambda value, _: f'{value:g}'))
        ax.xaxis.set_minor_formatter(NullFormatter())


def _matrix(paths: Sequence[Curve], path: Path) -> None:
    """Draw the magnitude of every reading per every voltage."""
    outputs = list(dict.fromkeys(c.output for c in paths))
    inputs = list(dict.fromkeys(c.input for c in paths))
    with figure(
        path, len(outputs), len(inputs), size=(3.0 * len(inputs) + 1.0, 2.0 * len(outputs) + 1.0),
        sharex=True, sharey=True,
    ) as (drawn, axes):  # fmt: skip
        for curve in paths:
            ax = axes[outputs.index(curve.output), inputs.index(curve.input)]
            m = curve.measured
            low, high = m.band
            ax.fill_between(m.frequency, _db(low), _db(high), color=STRUTS[0], alpha=0.25, lw=0)
            ax.plot(m.frequency, _db(m.magnitude), color=STRUTS[0], lw=2.0, label='measured')
            if curve.exact is not None:
                exact = _db(np.abs(curve.exact))
                ax.plot(
                    m.frequency,
                    exact,
                    color=INK,
                    ls='--',
                    lw=0.8,
                    label='exact response of the rig',
                )
        for i, name in enumerate(outputs):
            axes[i, 0].set_ylabel(f'{_label(name)}\nm/s² per V [dB]')
        for j, name in enumerate(inputs):
            axes[0, j].set_title(f'coil of {_label(name).lower()}')
            axes[-1, j].set_xlabel('frequency [Hz]')
        axes[0, 0].set_xscale('log')
        axes[0, 0].set_xlim(paths[0].measured.frequency[0], paths[0].measured.frequency[-1])
        axes[0, 0].set_ylim(*_limits(paths))
        _plain_ticks(axes.ravel())
        legend(drawn, axes.ravel())
