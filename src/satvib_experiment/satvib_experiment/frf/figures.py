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
from satvib_experiment.frf.curve import PATH, SURE, TRANSMISSIBILITY, Curve
from satvib_experiment.frf.merit import TRUSTED
from satvib_experiment.report.style import (
    FAINT,
    INK,
    MEASURED,
    MODEL,
    OPEN,
    STRUTS,
    figure,
    legend,
    plain_ticks,
)

MOST_COLUMNS = 3
# a line that lies on another one is thinner than that
_WIDE: dict[str, Any] = {'lw': 3.0, 'alpha': 0.55, 'solid_capstyle': 'butt'}
_MODEL: dict[str, Any] = {'color': MODEL, 'lw': 1.4, 'label': 'identified model'}
_EXACT: dict[str, Any] = {
    'color': INK, 'lw': 0.9, 'dashes': (5.0, 3.0), 'label': 'exact response of the rig', 'zorder': 3,
}  # fmt: skip
_MOST = 1.0 - 1e-5  # coherence at the upper end of its axis
_DEEPEST = 100.0  # dB below the largest level


def draw_figures(curves: Sequence[Curve], folder: Path, title: str = '') -> list[Path]:
    """Draw what there is: transmissibility.png, motions.png, paths.png, coupling.png.

    Args:
        curves: that were measured.
        folder: where to.
        title: stands above each figure.

    Raises:
        OSError: a file cannot be written.
    """
    moved = [c for c in curves if c.quantity == TRANSMISSIBILITY]
    struts = [c for c in moved if not c.is_motion]
    motions = [c for c in moved if c.is_motion]
    paths = [c for c in curves if c.quantity == PATH]
    drawn = []
    for name, chosen, unit in (
        ('transmissibility', struts, 'payload over base [dB]'),
        ('motions', motions, 'payload over base [dB]'),
        ('paths', [c for c in paths if c.output == c.input or len(paths) == 1], 'm/s² per V [dB]'),
    ):
        if chosen:
            drawn.append(folder / f'{name}.png')
            _three_rows(chosen, drawn[-1], unit, title)
    if len(paths) > 1:
        drawn.append(folder / 'coupling.png')
        _matrix(paths, drawn[-1], title)
    return drawn


def _colors(curves: Sequence[Curve]) -> dict[str, str]:
    """A colour for each loop: grey for the open one."""
    laws = [name for name in dict.fromkeys(c.loop for c in curves) if name != OPEN_LOOP]
    ordered = [STRUTS[0], MEASURED, STRUTS[2], STRUTS[3], STRUTS[4], STRUTS[5]]
    return {OPEN_LOOP: OPEN, **{law: ordered[i % 6] for i, law in enumerate(laws)}}


def _three_rows(curves: Sequence[Curve], path: Path, unit: str, title: str) -> None:
    """Draw a column of magnitude, phase and coherence for each output; all columns have the same axes."""
    outputs = list(dict.fromkeys(c.output for c in curves))
    columns = min(len(outputs), MOST_COLUMNS)
    bands = -(-len(outputs) // columns)
    colors = _colors(curves)
    if curves[0].quantity == PATH:
        colors[OPEN_LOOP] = STRUTS[0]
    with figure(
        path, 3 * bands, columns, size=(3.9 * columns + 1.0, 6.4 * bands), sharex=True,
        sharey='row', height_ratios=(3, 2, 1) * bands, title=title,
    ) as (drawn, axes):  # fmt: skip
        for row in range(3 * bands):
            for column in range(columns):
                if row // 3 * columns + column >= len(outputs):
                    axes[row, column].set_visible(False)
        for place, output in enumerate(outputs):
            band, column = divmod(place, columns)
            above, middle, below = axes[3 * band : 3 * band + 3, column]
            for curve in (c for c in curves if c.output == output):
                _draw(curve, colors[curve.loop], above, middle, below)
            above.set_title(_label(output))
            above.set_ylim(*_limits(curves))
            middle.set_ylim(-190.0, 190.0)
            middle.set_yticks((-180, -90, 0, 90, 180))
            _coherence_axis(below)
            below.tick_params(labelbottom=True)
            below.set_xlabel('frequency [Hz]')
            if column == 0:
                above.set_ylabel(unit)
                middle.set_ylabel('phase [°]')
                below.set_ylabel('coherence')
        axes[0, 0].set_xscale('log')
        axes[0, 0].set_xlim(
            min(c.measured.frequency[0] for c in curves),
            max(c.measured.frequency[-1] for c in curves),
        )
        plain_ticks(axes.ravel())
        legend(drawn, axes.ravel())


def _coherence_axis(ax: Any) -> None:
    """An axis by the share that the input does not explain: 0.9, 0.99, 0.999 at even distances."""
    ax.set_yscale('function', functions=(_nines, _coherence))
    ax.set_ylim(0.0, _MOST)
    ax.set_yticks((0.0, 0.9, 0.99, 0.999, 0.9999), ('0', '0.9', '0.99', '0.999', '0.9999'))
    ax.minorticks_off()
    ax.axhline(SURE, color=FAINT, lw=0.6, ls=':')


def _nines(coherence: Any) -> Any:
    return -np.log10(1.0 - np.clip(coherence, 0.0, _MOST))


def _coherence(nines: Any) -> Any:
    return 1.0 - 10.0 ** -np.asarray(nines)


def _draw(curve: Curve, color: str, above: Any, middle: Any, below: Any) -> None:
    """Draw a curve: measured wide and pale, what it is compared with thin and on top."""
    m = curve.measured
    # what noise says is left out; the coherence stays
    known = np.where(m.coherence < TRUSTED, np.nan, 1.0)
    low, high = m.band
    above.fill_between(
        m.frequency, _db(known * low), _db(known * high), color=color, alpha=0.25, lw=0
    )
    above.plot(m.frequency, _db(known * m.magnitude), color=color, label=_loop(curve), **_WIDE)
    phase = _broken(known * np.degrees(np.angle(m.value)))
    middle.plot(m.frequency, *phase, color=color, **_WIDE)
    # an undefined coherence leaves a gap
    below.plot(m.frequency, np.minimum(m.coherence, _MOST), color=color, lw=0.9)
    for other, style in ((curve.model, _MODEL), (curve.exact, _EXACT)):
        if other is not None:
            above.plot(m.frequency, _db(np.abs(other)), **style)
            middle.plot(m.frequency, *_broken(np.degrees(np.angle(other))), **style)
    above.axhline(0.0, color=FAINT, lw=0.6, ls=':')


def _broken(phase: Any) -> tuple[Any]:
    """A phase whose line is broken where it wraps."""
    shown = np.asarray(phase, dtype=float).copy()
    shown[1:][np.abs(np.diff(shown)) > 180.0] = np.nan
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
    """Limits of an axis in dB: all that is measured with some coherence, and all that is exact."""
    levels = []
    for curve in curves:
        sure = ~(curve.measured.coherence < TRUSTED)
        levels.append(_db(curve.measured.magnitude)[sure])
        if curve.exact is not None:
            levels.append(_db(np.abs(curve.exact)))
    every = np.concatenate(levels)
    every = every[np.isfinite(every)]
    if not every.size:
        return -60.0, 20.0
    high = float(every.max())
    return max(float(every.min()), high - _DEEPEST) - 3.0, high + 3.0


def _matrix(paths: Sequence[Curve], path: Path, title: str) -> None:
    """Draw the magnitude of every reading per every voltage."""
    outputs = list(dict.fromkeys(c.output for c in paths))
    inputs = list(dict.fromkeys(c.input for c in paths))
    with figure(
        path, len(outputs), len(inputs), size=(3.0 * len(inputs) + 1.0, 2.0 * len(outputs) + 1.0),
        sharex=True, sharey=True, title=title,
    ) as (drawn, axes):  # fmt: skip
        for curve in paths:
            ax = axes[outputs.index(curve.output), inputs.index(curve.input)]
            m = curve.measured
            low, high = m.band
            ax.fill_between(m.frequency, _db(low), _db(high), color=STRUTS[0], alpha=0.25, lw=0)
            ax.plot(m.frequency, _db(m.magnitude), color=STRUTS[0], label='measured', **_WIDE)
            if curve.exact is not None:
                ax.plot(m.frequency, _db(np.abs(curve.exact)), **_EXACT)
        for i, name in enumerate(outputs):
            axes[i, 0].set_ylabel(f'{_label(name)}\nm/s² per V [dB]')
        for j, name in enumerate(inputs):
            axes[0, j].set_title(f'coil of {_label(name).lower()}')
            axes[-1, j].set_xlabel('frequency [Hz]')
        axes[0, 0].set_xscale('log')
        axes[0, 0].set_xlim(paths[0].measured.frequency[0], paths[0].measured.frequency[-1])
        axes[0, 0].set_ylim(*_limits(paths))
        plain_ticks(axes.ravel())
        legend(drawn, axes.ravel())
