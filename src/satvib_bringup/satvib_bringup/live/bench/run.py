# SPDX-FileCopyrightText: 2026 The satvib authors
# SPDX-License-Identifier: Apache-2.0
"""The bare graph and satvib in turns, so that what else the machine does meets both."""

import os
import platform
import tempfile
from collections.abc import Callable, Sequence
from dataclasses import asdict
from pathlib import Path
from typing import Any

from satvib_common.transport.reach import set_transport

from satvib_bringup.live.bench.case import Case, Figures, medians
from satvib_bringup.live.bench.floor import run_floor
from satvib_bringup.live.bench.satvib_graph import run_satvib

Runner = Callable[[Case, str, Path], Figures]


def bench(
    cases: Sequence[Case], rounds: int, progress: Callable[[str], None] | None = None
) -> dict[str, Any]:
    """Measure cases.

    Args:
        cases: what is measured.
        rounds: how often each graph runs; figures are medians.
        progress: called with what is being measured.

    Returns:
        What the JSON file holds: the machine, and for each case and graph its figures, their span, their ratio to the
        first floor, and every single run.
    """
    set_transport()
    found = []
    for case in cases:
        runs: dict[str, list[Figures]] = {}
        for number in range(rounds):
            for kind, composition, run in _turn(case):
                name = f'{kind} {composition}'
                if progress is not None:
                    progress(f'{case.name}, {name}, round {number + 1} of {rounds}')
                with tempfile.TemporaryDirectory(prefix='satvib-bench-') as place:
                    runs.setdefault(name, []).append(run(case, composition, Path(place) / 'run'))
        found.append(summary(case, runs))
    return {'machine': machine(), 'rounds': rounds, 'cases': found}


def machine() -> dict[str, Any]:
    """What the figures depend on."""
    return {
        'processors': len(os.sched_getaffinity(0)),
        'load': round(os.getloadavg()[0], 1),
        'kernel': platform.release(),
        'python': platform.python_version(),
    }


def _turn(case: Case) -> list[tuple[str, str, Runner]]:
    floors: list[tuple[str, str, Runner]] = [('bare', c, run_floor) for c in case.floors]
    return floors + [('satvib', c, run_satvib) for c in case.compositions]


def summary(case: Case, runs: dict[str, list[Figures]]) -> dict[str, Any]:
    """Medians, spans and ratios of the runs of a case, by graph."""
    floor, _ = medians(runs[f'bare {case.floors[0]}'])
    graphs = {}
    for name, figures in runs.items():
        middle, span = medians(figures)
        ratio = {key: value / floor[key] for key, value in middle.items() if floor.get(key)}
        graphs[name] = {
            'median': middle,
            'span': span,
            'ratio': ratio,
            'failed': [f.failed for f in figures if f.failed],
            'runs': [asdict(f) for f in figures],
        }
    return {'case': asdict(case), 'name': case.name, 'graphs': graphs}
