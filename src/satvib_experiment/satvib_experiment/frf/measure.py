# SPDX-FileCopyrightText: 2026 The satvib authors
# SPDX-License-Identifier: Apache-2.0
"""Measures frequency responses: of a scenario by the offline twin, of a recorded run, of a measured record."""

import math
from collections import Counter
from collections.abc import Callable, Sequence
from dataclasses import dataclass, field
from pathlib import Path

import numpy as np
from satvib_common.arrays import Array
from satvib_common.errors import SatvibError
from satvib_common.phases import Phase
from satvib_common.records.record import MeasuredColumns
from satvib_ident.frequency.settings import FrfSettings

from satvib_experiment.analysis.shortfalls import shortfalls
from satvib_experiment.analysis.tones import disturbance_tones
from satvib_experiment.frf.curve import OPEN, PATH, TRANSMISSIBILITY, Curve
from satvib_experiment.frf.how import Moved, estimate, period_samples
from satvib_experiment.frf.lines import OnlyTones
from satvib_experiment.frf.measurement import MeasurementSettings, base_scenario, coil_scenario
from satvib_experiment.frf.paths import coupling, secondary_paths
from satvib_experiment.frf.transmission import (
    check_moved,
    direction_notes,
    resolution_notes,
    transmissibilities,
)
from satvib_experiment.recording.recording import Recording, run_title
from satvib_experiment.recording.run_folder import write_scenario
from satvib_experiment.scenario.scenario import Scenario, check_scenario

Run = Callable[[Scenario], Recording]


@dataclass(frozen=True)
class Measured:
    """Everything that was measured.

    Attributes:
        source: of what, for people.
        curves: see `Curve`.
        coupling: frequency of each coil and the matrix of ratios, None without paths.
        notes: what must be known, in sentences.
        title: of its figures.
        shortfalls: why the recorded run is no result, in sentences; empty for a sound one.
        highest: Hz, half the sample rate.
        warnings: what must be known before all else, in sentences.
    """

    source: str
    curves: list[Curve]
    coupling: tuple[list[float], Array] | None = None
    notes: list[str] = field(default_factory=list)
    title: str = ''
    shortfalls: list[str] = field(default_factory=list)
    highest: float = math.inf
    warnings: list[str] = field(default_factory=list)


def measure_scenario(
    scenario: Scenario,
    run: Run,
    measurement: MeasurementSettings,
    settings: FrfSettings,
    laws: Sequence[str] = (),
    excite: Sequence[str] = ('base', 'coils'),
    folder: Path | None = None,
) -> Measured:
    """Measure a scenario's rig: the base with each law, then the coils.

    Args:
        scenario: whose rig, identification and law are measured.
        run: runs a scenario.
        measurement: what moves.
        settings: of the estimates.
        laws: that are compared; empty: the scenario's.
        excite: 'base', 'coils' or both.
        folder: where the scenarios of the measurements are kept.

    Raises:
        SatvibError: a measurement that rig, band or law refuse.
    """
    curves: list[Curve] = []
    notes: list[str] = []
    modelled: Recording | None = None
    title = scenario.name
    # what is wrong with any of them shows before the first one runs
    bases = [(law, base_scenario(scenario, measurement, law)) for law in laws or ('',)]
    coils = coil_scenario(scenario, measurement) if 'coils' in excite else None
    for number, (law, made) in enumerate(bases if 'base' in excite else ()):
        recording = _run(made, run, folder, 'base' if not number else f'base-{law}')
        modelled = modelled or recording
        title = run_title(modelled, laws or [modelled.law], scenario.name)
        found = transmissibilities(recording, settings)
        curves += [c for c in found if c.loop != OPEN or not number]
        notes += _reasons(recording, law)
    if coils is not None:
        recording = _run(coils, run, folder, 'coils')
        curves += secondary_paths(recording, settings, modelled)
        if modelled is None:
            title = run_title(recording, [], scenario.name)
    return Measured(scenario.name, curves, coupling(curves, _struts(curves)), notes, title)


def _run(scenario: Scenario, run: Run, folder: Path | None, name: str) -> Recording:
    check_scenario(scenario, scenario.name)
    if folder is not None:
        write_scenario(scenario, folder, f'{name}.yaml')
    return run(scenario)


def _struts(curves: Sequence[Curve]) -> tuple[str, ...]:
    """The struts whose coils were driven."""
    return tuple(dict.fromkeys(c.input for c in curves if c.quantity != TRANSMISSIBILITY))


def _reasons(recording: Recording, law: str) -> list[str]:
    """Say why a controller did not act as its law wants, and for how much of CONTROL."""
    control = recording.phase == Phase.CONTROL
    if not recording.has('state', 'reason') or not control.any():
        return []
    texts: dict[tuple[str, str], list[str]] = {}
    for strut, column in zip(
        recording.struts, recording.get('state', 'reason')[control].T, strict=True
    ):
        for text, count in Counter(column.tolist()).items():
            if text:
                share = f'{100.0 * count / len(column):.0f} % of CONTROL'
                texts.setdefault((str(text), share), []).append(strut.replace('_', ' '))
    head = f'{law}: ' if law else ''
    return [
        f'{head}controller of {", ".join(struts)}, {share}: {text}'
        for (text, share), struts in texts.items()
    ]


def measure_recording(
    recording: Recording, settings: FrfSettings, period: float | None = None
) -> Measured:
    """Measure what a recorded run shows: its stretches without and under control, and its coils in IDENTIFY.

    Raises:
        SatvibError: nothing in it tells a frequency response.
    """
    curves: list[Curve] = []
    tonal: list[OnlyTones] = []
    try:
        curves += transmissibilities(recording, settings, period)
    except OnlyTones as found:
        scenario = recording.scenario
        tones = disturbance_tones(scenario.make_disturbance()) if scenario else []
        tonal.append(found.of('the base', tones))
    try:
        curves += secondary_paths(recording, settings)
    except OnlyTones as found:
        tonal.append(found.of('a coil'))
    if tonal and not curves:
        raise SatvibError(f'{recording.source}: {tonal[0]}')
    check_moved(curves, recording)
    notes = [*map(str, tonal), *recording.notes]
    notes += [*direction_notes(recording), *resolution_notes(curves)]
    notes += _reasons(recording, '')
    coupled = coupling(curves, _struts(curves))
    worthless = shortfalls(recording)
    highest = 0.5 / recording.sample_period
    return Measured(recording.source, curves, coupled, notes, recording.title, worthless, highest)


def measure_columns(
    record: MeasuredColumns,
    settings: FrfSettings,
    names: tuple[str, str],
    path: bool = False,
    period: float | None = None,
) -> Measured:
    """Measure the response from the first to the second column of a record.

    Args:
        record: the record.
        settings: of the estimate.
        names: of input and output.
        path: the input is a voltage; otherwise it is the acceleration of the base.
        period: s, after which the input repeats; None: it does not.

    Raises:
        SatvibError: too short, or a period that is no whole number of samples.
    """
    try:
        samples = 0 if period is None else period_samples(period, record.dt)
        x, y = record.values
        for name, signal in zip(names, (x, y), strict=True):
            _check_moves(name, signal)
        found = estimate(x, y, record.dt, Moved(period=samples), settings)
    except OnlyTones as error:
        raise SatvibError(f'{record.name}: {error.of(names[0])}') from None
    except SatvibError as error:
        raise SatvibError(f'{record.name}: {error}') from None
    curve = Curve(PATH if path else TRANSMISSIBILITY, OPEN, names[1], names[0], found)
    notes = list(record.notes)
    return Measured(
        record.name, [curve], None, notes, record.name, [], 0.5 / record.dt, record.warnings
    )


def _check_moves(name: str, signal: Array) -> None:
    """Refuse a channel that shows nothing."""
    known = signal[np.isfinite(signal)]
    if known.size and np.all(known == known[0]):
        raise SatvibError(f'{name} is {known[0]:g} throughout')
