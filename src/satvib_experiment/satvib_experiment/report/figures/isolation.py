# SPDX-FileCopyrightText: 2026 The satvib authors
# SPDX-License-Identifier: Apache-2.0
"""Transmissibility, third octaves against the criteria for vibration, and cumulative RMS of a run."""

from pathlib import Path
from typing import Any

import numpy as np
from satvib_common.levels import decibel
from satvib_common.struts.names import strut_label
from satvib_plant_sim.disturbance.base import UPWARD

from satvib_experiment.analysis.bands import (
    CRITERIA,
    HIGHEST,
    criterion_limit,
    cumulative_rms,
    power_lines,
)
from satvib_experiment.frf.curve import OPEN as OPEN_LOOP
from satvib_experiment.frf.exact import base_direction, exact_plates
from satvib_experiment.report.context import Context
from satvib_experiment.report.judged import (
    broadband_curves,
    octaves,
    payload_signal,
    stretch,
    tone_transmissibility,
)
from satvib_experiment.report.style import (
    FAINT,
    INK,
    OPEN,
    STRUTS,
    figure,
    legend,
    log_scale,
    plain_ticks,
)

CAPTION = (
    'Left: transmissibility, payload over base: measured open loop (grey) and under control (colours), at the tones of '
    'the run or by frequency; dashed: the exact response of the rig, open loop, and dotted with a law that is a fixed '
    'filter. Middle: RMS velocity of the payload in third octaves, against the criteria of ISO and the VC curves (at 8 '
    'Hz and above, from top to bottom: workshop, office, residential, operating theatre, VC-A to VC-E). Right: RMS '
    'acceleration of everything at and above a frequency; its left end is the RMS of the table of attenuation, of the '
    'same stretches. Both from the truth where there is truth.'
)
_EXACT = {'--': 'exact, open loop', ':': 'exact, with the law'}
_STILL = 1e-3  # share of the largest power at a foot, up to which it does not move along its strut
_LINES = 160
_LOWEST = 1.0  # Hz
_DECADES = 5.0


def draw(context: Context, path: Path) -> bool:
    """Draw the figure; False when there is no stretch to look at."""
    if stretch(context, 'controlled') is None and stretch(context, 'uncontrolled') is None:
        return False
    with figure(path, 1, 3, size=(12.6, 4.2), title=context.recording.title) as (drawn, axes):
        _transmissibility(context, axes[0, 0])
        _octaves(context, axes[0, 1])
        _cumulative(context, axes[0, 2])
        plain_ticks(axes[0])
        legend(drawn, axes[0])
    return True


def caption(context: Context) -> str:
    """Give the caption, with the direction of the exact response where it is not that of every rig."""
    direction, why = _direction(context)
    if direction is None:
        return f'{CAPTION} No exact response is drawn: {why}.'
    if direction == UPWARD:
        return CAPTION
    factors = ' '.join(f'{v + 0.0:.3g}' for v in direction)
    return (
        f'{CAPTION} The base of the exact response moves as that of the run did, with the factors {factors} along and '
        'then about x, y, z; a strut whose foot does not move along it has none.'
    )


def _direction(context: Context) -> tuple[tuple[float, ...] | None, str]:
    shown = (stretch(context, name) for name in (_baseline(context), 'controlled'))
    return base_direction(context.recording, [found[1] for found in shown if found])


def _baseline(context: Context) -> str:
    """The stretch without control: of the run, or of its open-loop twin."""
    return 'uncontrolled' if stretch(context, 'uncontrolled') else 'open_loop'


def _color(i: int) -> str:
    return STRUTS[i % len(STRUTS)]


def _transmissibility(context: Context, ax: Any) -> None:
    recording = context.recording
    nyquist = 0.5 / recording.sample_period
    f = np.geomspace(_LOWEST, 0.98 * nyquist, _LINES)
    direction, _ = _direction(context)
    for style in _EXACT:
        plates = None if direction is None else exact_plates(recording, f, style == ':', direction)
        if plates is None:
            continue
        power = np.mean(np.abs(plates[1]) ** 2, axis=0)
        label: str | None = _EXACT[style]
        # above what is measured, and thinner
        for i in map(int, np.flatnonzero(power > _STILL * np.max(power))):
            exact = decibel(np.abs(plates[0][:, i]), np.abs(plates[1][:, i]))
            color = INK if style == '--' else _color(i)
            ax.plot(f, exact, style, color=color, lw=0.9, zorder=3, label=label)
            label = None
    curves = broadband_curves(context)
    for curve in curves:
        i = context.struts.index(curve.output)
        color = OPEN if curve.loop == OPEN_LOOP else _color(i)
        ax.plot(curve.measured.frequency, curve.measured.decibels, color=color, lw=2.4, alpha=0.55)
    for name in () if curves else (_baseline(context), 'controlled'):
        found = tone_transmissibility(context, name)
        if found is None:
            continue
        for i in range(len(context.struts)):
            color = _color(i) if name == 'controlled' else OPEN
            ax.plot(found.frequency, decibel(found.magnitude[i]), 'o', ms=5, color=color)
    ax.axhline(0.0, color=FAINT, lw=0.6)
    ax.set_xscale('log')
    ax.set_xlim(_LOWEST, nyquist)
    ax.set_xlabel('frequency [Hz]')
    ax.set_ylabel('dB')
    ax.set_title('payload over base')


def _octaves(context: Context, ax: Any) -> None:
    f = np.geomspace(1.0, HIGHEST, 60)
    for criterion in CRITERIA:
        iso = 'ISO' in criterion.name
        ax.plot(
            f, 1e6 * criterion_limit(criterion, f), color=FAINT, lw=0.7, ls='-' if iso else '--'
        )
    for name in (_baseline(context), 'controlled'):
        found = octaves(context, name)
        if found is None:
            continue
        for i in range(len(context.struts)):
            on = name == 'controlled'
            label = strut_label(context.struts[i]) if on else 'control off' if i == 0 else None
            ax.plot(
                found[0], 1e6 * found[1][:, i], color=_color(i) if on else OPEN, lw=1.1,
                drawstyle='steps-mid', label=label,
            )  # fmt: skip
    ax.set_xscale('log')
    log_scale(ax, _DECADES)
    ax.set_xlim(1.0, HIGHEST * 1.1)
    ax.set_xlabel('third octave [Hz]')
    ax.set_ylabel('µm/s RMS')
    ax.set_title('criteria for vibration')


def _cumulative(context: Context, ax: Any) -> None:
    top = 0.0
    for name in (_baseline(context), 'controlled'):
        found = stretch(context, name)
        if found is None:
            continue
        signal, dt = payload_signal(*found)
        f, power = power_lines(signal, dt)
        total = cumulative_rms(power)
        top = max(top, float(f[-1]))
        for i in range(len(context.struts)):
            on = name == 'controlled'
            ax.plot(f, total[:, i], color=_color(i) if on else OPEN, lw=1.1)
    ax.set_xscale('log')
    log_scale(ax, _DECADES)
    ax.set_xlim(_LOWEST, min(top, 500.0))
    ax.set_xlabel('above this frequency [Hz]')
    ax.set_ylabel('m/s² RMS')
    ax.set_title('cumulative RMS')
