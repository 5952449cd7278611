# SPDX-FileCopyrightText: 2026 The satvib authors
# SPDX-License-Identifier: Apache-2.0
"""A sweep: scenarios varied along named axes, every combination a run of the offline twin.

    base: {keys of a scenario that all cells share}
    axes:
      rig:         {paper_3dof: {rig: paper_3dof}, ...}
      law:         {narrowband: {controller: {law: narrowband}}, ...}

Each label of an axis holds further keys of a scenario; later axes win, nested mappings are merged. What belongs to no
label alone stands in `exceptions`, which win over all:

    exceptions:
      - {labels: {rate: 1000 Hz, latency: 5 ms}, keys: {identifier: {delay: 6}}}
"""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import dataclass
from itertools import product
from pathlib import Path
from typing import Any

import numpy as np
from satvib_common.errors import SatvibError
from satvib_common.files.suggestions import nearest
from satvib_common.phases import Phase
from satvib_common.process.parallel import cores, run_in_processes
from satvib_common.schema import Schema, param
from satvib_experiment.recording.recording import Recording
from satvib_experiment.scenario.memory import check_needs
from satvib_experiment.scenario.scenario import Scenario, check_scenario
from satvib_experiment.scenario.settings_file import called, load_settings, names_in, settings_path

FOLDER = Path(__file__).parents[1] / 'sweeps'
_CELL = 5000.0  # bytes of a cell, at least
_CELL_TIME = 5e-3  # s of a processor for a cell, at least
KINDS = ('measured_rms', 'measured_tone', 'true_rms', 'true_tone')


@dataclass(frozen=True, kw_only=True)
class SweepFigure(Schema):
    """What the figure of a sweep shows, by names of its axes."""

    x: str = param(description='axis along which attenuation is drawn')
    panel: str = param(description='axis with a panel for every label')
    line: str = param(description='axis with a line for every label')
    fixed: dict[str, Any] = param(dict, 'by axis: the one label that is drawn')


@dataclass(frozen=True, kw_only=True)
class SweepSummary(Schema):
    """A short table: one axis down, one across, all others fixed."""

    row: str = param(description='axis with a line for every label')
    column: str = param(description='axis with a column for every label')
    fixed: dict[str, Any] = param(dict, 'by axis: the one label that is shown')


@dataclass(frozen=True, kw_only=True)
class SweepException(Schema):
    """Keys of the cells that have all of some labels."""

    labels: dict[str, Any] = param(description='by axis: the label')
    keys: dict[str, Any] = param(description='keys of a scenario')


@dataclass(frozen=True, kw_only=True)
class Sweep(Schema):
    """What is varied, over a base that all cells share."""

    name: str = param(description='name of the sweep')
    description: str = param('', 'what it shows')
    base: dict[str, Any] = param(description='keys of a scenario that all cells share')
    axes: dict[str, Any] = param(description='by name of the axis: by label: keys of a scenario')
    exceptions: tuple[SweepException, ...] = param((), 'keys of cells with several labels at once')
    figure: SweepFigure | None = param(None, 'what is drawn; none: nothing')
    summary: SweepSummary | None = param(None, 'the short table for a page; none: nothing')

    def check(self) -> None:
        """Check the shape of the axes; their keys are checked cell by cell."""
        if not self.axes:
            raise SatvibError('axes: at least one is needed')
        for name, axis in self.axes.items():
            if not isinstance(axis, dict) or not axis:
                raise SatvibError(f'axes.{name}: a mapping of labels is expected')
            for label, keys in axis.items():
                if not isinstance(keys, dict):
                    raise SatvibError(f'axes.{name}.{label}: a mapping of keys is expected')

        self._check_labels()

    def _check_labels(self) -> None:
        drawn, short = self.figure, self.summary
        named: list[tuple[str, str, Any]] = []
        if drawn:
            named += [('figure', axis, None) for axis in (drawn.x, drawn.panel, drawn.line)]
            named += [('figure', *item) for item in drawn.fixed.items()]
        if short:
            named += [('summary', axis, None) for axis in (short.row, short.column)]
            named += [('summary', *item) for item in short.fixed.items()]
        for exception in self.exceptions:
            named += [('exceptions', *item) for item in exception.labels.items()]
        for where, axis, label in named:
            if axis not in self.axes:
                raise SatvibError(f'{where}: no axis {axis!r}; {nearest(axis, list(self.axes))}')
            if label is not None and label not in self.axes[axis]:
                known = nearest(str(label), list(self.axes[axis]))
                raise SatvibError(f'{where}: axis {axis} has no label {label!r}; {known}')

    def cells(self) -> list[Cell]:
        """Every combination, checked, the last axis fastest.

        Raises:
            SatvibError: a cell that is no scenario; the cell is named.
        """
        count = math.prod(len(axis) for axis in self.axes.values())
        check_needs(f'sweep {self.name}: axes: {count} cells', _CELL * count, _CELL_TIME * count)
        return [self._cell(labels) for labels in product(*self.axes.values())]

    def _cell(self, labels: tuple[str, ...]) -> Cell:
        named = dict(zip(self.axes, labels, strict=True))
        data: dict[str, Any] = {'name': self.name, **self.base}
        for axis, label in named.items():
            data = merged(data, self.axes[axis][label])
        for exception in self.exceptions:
            if all(named[axis] == label for axis, label in exception.labels.items()):
                data = merged(data, exception.keys)
        where = f'sweep {self.name}: {", ".join(labels)}'
        scenario = Scenario.from_mapping(data, where)
        check_scenario(scenario, where)
        return Cell(named, scenario)


@dataclass(frozen=True)
class Cell:
    """One combination: its label on every axis, and the scenario."""

    labels: dict[str, str]
    scenario: Scenario


def merged(below: dict[str, Any], above: dict[str, Any]) -> dict[str, Any]:
    """Merge two mappings into a new one; nested mappings are merged, of other values the upper one wins."""
    result = dict(below)
    for key, value in above.items():
        old = result.get(key)
        if isinstance(old, dict) and isinstance(value, dict):
            value = merged(old, value)
        result[key] = value
    return result


def sweep_names() -> list[str]:
    """Names of the sweeps that come with the package."""
    return names_in(FOLDER)


def load_sweep(name_or_path: str | Path, overrides: list[str] | None = None) -> Sweep:
    """Load a sweep.

    Args:
        name_or_path: a name of `sweep_names()`, or the path of a YAML file.
        overrides: 'key=value' with dots, as in base.seed=3.

    Raises:
        SatvibError: no such sweep, or a wrong key in it.
    """
    path = settings_path('sweep', name_or_path, FOLDER)
    where = called('sweep', path, FOLDER)
    return Sweep.from_mapping(load_settings(path, overrides or []), where)


def run_cell(cell: Cell) -> dict[str, Any]:
    """Run one cell and give its row: per strut in dB (NaN is None), the worst strut, and what the laws said."""
    from satvib_common.levels import decibel
    from satvib_experiment.analysis.analysis import analyse
    from satvib_experiment.twin.closed_loop import simulate

    recording = simulate(cell.scenario)
    e, _ = analyse(recording)
    floor = decibel(np.array(e.noise), e.levels['open_loop']['measured_rms'])
    figures = {kind: e.attenuation_open_loop[kind] for kind in KINDS}
    figures |= {
        'noise_floor': floor,
        'settling_time': e.settling_time,
        'largest_amplification': e.largest_amplification,
        'largest_voltage': e.largest_voltage,
        'largest_control_voltage': _control_voltage(recording),
    }
    return {
        'labels': cell.labels,
        'seed': cell.scenario.seed,
        'struts': {name: _plain(values) for name, values in figures.items()},
        'worst': {name: _worst(values) for name, values in figures.items()},
        'reasons': sorted({str(text) for text in recording.get('state', 'reason')[-1] if text}),
    }


def _control_voltage(recording: Recording) -> Any:
    """Largest voltage in CONTROL, (struts,) V; 0: the law never acted."""
    voltage = np.abs(recording.get('voltage', 'voltage')[recording.phase == Phase.CONTROL])
    return np.max(voltage, axis=0, initial=0.0)


def _plain(values: Any) -> list[float | None]:
    return [float(v) if math.isfinite(v) else None for v in values]


def _worst(values: Any) -> float | None:
    return float(np.max(values)) if np.all(np.isfinite(values)) else None


def run_sweep(cells: list[Cell], jobs: int | None = None) -> Iterator[tuple[int, dict[str, Any]]]:
    """Run cells on several processes and give (index, row) as they are done; the rows do not depend on `jobs`.

    Raises:
        SatvibError: a cell failed; it is named.
    """
    jobs = min(jobs or cores(), len(cells))
    if jobs == 1:
        for index, cell in enumerate(cells):
            yield index, run_cell(cell)
        return
    yield from run_in_processes(
        run_cell,
        lambda i: (cells[i],),
        range(len(cells)),
        jobs,
        called=lambda i: f'cell {", ".join(cells[i].labels.values())}',
        advice='fewer processes need less: --jobs 1',
    )
