# SPDX-FileCopyrightText: 2026 The satvib authors
# SPDX-License-Identifier: Apache-2.0
"""The figure of a judgement: transmissibility of every law on a rig, beside its open loop and its exact response."""

from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

import numpy as np
from satvib_common.levels import decibel
from satvib_experiment.frf.curve import Curve
from satvib_experiment.frf.merit import merit_of
from satvib_experiment.report.style import FAINT, INK, STRUTS, figure
from satvib_experiment.report.style import OPEN as GREY

from satvib_studies.isolation.cases import KINDS, OPEN, Isolation
from satvib_studies.isolation.numbers import HEAVE
from satvib_studies.isolation.runs import LawFound

_HEADINGS = {'fixed': 'feedback laws', 'adaptive': 'laws that cancel or learn'}
_SURE = 0.3  # coherence below which a line is not drawn


def draw(
    isolation: Isolation,
    found: Mapping[tuple[str, str], LawFound],
    rig: str,
    laws: Sequence[str],
    path: Path,
) -> None:
    """Draw the first seed: heave above, the worst strut below; feedback at the left, laws that learn at the right."""
    cases = isolation.law_list()
    still = found[rig, OPEN].curves[0]
    with figure(path, 2, 2, size=(11.0, 8.2), sharex=True, sharey=True) as (_, axes):
        for column, kind in enumerate(KINDS):
            shown = [law for law in laws if cases[law].kind == kind]
            for row, (chosen, label) in enumerate(((_heave, 'heave'), (_worst, 'worst strut'))):
                ax = axes[row, column]
                ax.set_title(f'{label}, {_HEADINGS[kind]}')
                quiet = chosen(still)
                _line(ax, quiet, color=GREY, lw=3.0, label='open loop')
                for law, color in zip(shown, STRUTS, strict=False):
                    mine = chosen(found[rig, law].curves[0])
                    _line(ax, mine, color=color, lw=1.3, label=cases[law].title)
                if quiet.exact is not None:
                    f = quiet.measured.frequency
                    ax.plot(
                        f, decibel(np.abs(quiet.exact)), color=INK, ls='--', lw=0.8,
                        label='open loop, exact',
                    )  # fmt: skip
                ax.axhline(0.0, color=FAINT, lw=0.6, ls=':')
                if column == 0:
                    ax.set_ylabel('payload over base [dB]')
                if row == 1:
                    ax.set_xlabel('frequency [Hz]')
                    # below, where it hides no curve
                    ax.legend(loc='upper center', bbox_to_anchor=(0.5, -0.15), ncols=2, fontsize=8)
        _scale(axes, isolation)


def _heave(curves: Sequence[Curve]) -> Curve:
    return next(c for c in curves if c.output == HEAVE)


def _worst(curves: Sequence[Curve]) -> Curve:
    def peak(curve: Curve) -> float:
        merit = merit_of(curve.measured)
        return merit.peak if merit else -np.inf

    return max((c for c in curves if c.output.startswith('strut')), key=peak)


def _line(ax: Any, curve: Curve, **style: Any) -> None:
    m = curve.measured
    level = np.where(m.coherence >= _SURE, m.decibels, np.nan)
    ax.plot(m.frequency, level, **style)


def _scale(axes: Any, isolation: Isolation) -> None:
    from matplotlib.ticker import FuncFormatter, LogLocator, NullFormatter

    first = axes[0, 0]
    first.set_xscale('log')
    first.set_xlim(isolation.measurement.low, isolation.measurement.high or 100.0)
    first.set_ylim(-50.0, 30.0)
    for ax in axes.ravel():
        ax.xaxis.set_major_locator(LogLocator(subs=(1.0, 2.0, 5.0)))
        ax.xaxis.set_major_formatter(FuncFormatter(lambda value, _: f'{value:g}'))
        ax.xaxis.set_minor_formatter(NullFormatter())
