# SPDX-FileCopyrightText: 2026 The satvib authors
# SPDX-License-Identifier: Apache-2.0
"""`satvib frf`: measured frequency responses: transmissibility, secondary paths, coupling."""

import math
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any, NamedTuple, TypeVar

import typer

from satvib_bringup.cli.options import Recover, Settings

if TYPE_CHECKING:
    from rich.console import Console
    from satvib_common.schema import Schema
    from satvib_experiment.frf.measure import Measured
    from satvib_ident.frequency.settings import FrfSettings

_Settings = TypeVar('_Settings', bound='Schema')


class _Asked(NamedTuple):
    """What is asked for of a file."""

    input: str | None
    output: str | None
    input_unit: str | None
    output_unit: str | None
    path: bool
    time: str | None
    sample_period: float | None


EXCITE = {'base': ('base',), 'coils': ('coils',), 'both': ('base', 'coils')}


def frf(
    source: Annotated[
        str,
        typer.Argument(
            help='A scenario: its rig is measured by the offline twin. A bag or the folder of a run: what it shows. '
            'A file of columns: one input and one output.',
            metavar='SOURCE',
        ),
    ],
    settings: Settings = None,
    law: Annotated[
        list[str] | None,
        typer.Option('--law', help='Scenario: the law that acts; many times: laws to compare.'),
    ] = None,
    excite: Annotated[
        str, typer.Option('--excite', help='Scenario: base, coils or both.')
    ] = 'both',
    signal: Annotated[
        str, typer.Option('--signal', help='Scenario: multisine, random, swept or stepped.')
    ] = 'multisine',
    low: Annotated[float | None, typer.Option('--low', help='Lower edge of the band, Hz.')] = None,
    high: Annotated[
        float | None, typer.Option('--high', help='Upper edge of the band, Hz.')
    ] = None,
    duration: Annotated[
        float | None, typer.Option('--duration', help='Scenario: s of each stretch.')
    ] = None,
    level: Annotated[
        float | None, typer.Option('--level', help='Scenario: m/s^2 RMS of the base.')
    ] = None,
    direction: Annotated[
        str | None,
        typer.Option(
            '--direction',
            help='Scenario: of the base, as in 1,0,0 (x, y, z) or 0,0,0,1,0,0 (and about them); else up and down.',
            metavar='X,Y,Z',
        ),
    ] = None,
    coil_level: Annotated[
        float | None, typer.Option('--coil-level', help='Scenario: V, peak, of a coil.')
    ] = None,
    period: Annotated[
        float | None,
        typer.Option('--period', help='s, after which the excitation repeats; no leakage then.'),
    ] = None,
    input_column: Annotated[
        str | None, typer.Option('--input', help='File: column of the input.', metavar='COL')
    ] = None,
    output_column: Annotated[
        str | None, typer.Option('--output', help='File: column of the output.', metavar='COL')
    ] = None,
    input_unit: Annotated[
        str | None, typer.Option('--input-unit', help='File: unit of the input, as in g or mV.')
    ] = None,
    output_unit: Annotated[
        str | None, typer.Option('--output-unit', help='File: unit of the output.')
    ] = None,
    path_input: Annotated[
        bool,
        typer.Option(
            '--path', help='File: the input is a voltage, not the acceleration of the base.'
        ),
    ] = False,
    time: Annotated[
        str | None,
        typer.Option('--time', help='File: time column; else by its name.', metavar='COL'),
    ] = None,
    sample_period: Annotated[
        float | None, typer.Option('--sample-period', help='File: s; else from the time column.')
    ] = None,
    estimator: Annotated[
        str,
        typer.Option(
            '--estimator', help='H1 (noise at the output), H2 (at the input), Hv (at both).'
        ),
    ] = 'H1',
    window: Annotated[str, typer.Option('--window', help='hann, hamming, boxcar ...')] = 'hann',
    overlap: Annotated[float, typer.Option('--overlap', help='Share of a segment.')] = 0.5,
    resolution: Annotated[
        float | None, typer.Option('--resolution', help='Hz, spacing of the lines.')
    ] = None,
    averages: Annotated[
        int | None, typer.Option('--averages', help='Segments to average over; else 16.')
    ] = None,
    confidence: Annotated[
        float, typer.Option('--confidence', help='Probability of the band.')
    ] = 0.95,
    recover: Recover = False,
    folder: Annotated[
        Path | None, typer.Option('--folder', help='New folder. Without it: runs/NAME-frf-NUMBER.')
    ] = None,
) -> None:
    """Measure frequency responses: payload over base, strut by strut and motion by motion; voltage to acceleration.

    Prints peak, roll-off, where isolation begins and how sure that is; writes frf.json, frf.csv and figures into a new
    folder. Of a scenario also the experiments themselves (base.yaml, coils.yaml), which run live, too.
    """
    from satvib_common.errors import SatvibError
    from satvib_experiment.frf.output import frf_mapping, write_frf
    from satvib_experiment.recording.run_folder import free_run_folder, make_run_folder
    from satvib_ident.frequency.settings import FrfSettings

    from satvib_bringup.cli.console import make_console
    from satvib_bringup.cli.frf_view import show_frf

    if excite not in EXCITE:
        raise SatvibError(f'--excite: {excite!r} is not one of {", ".join(EXCITE)}')
    if sample_period is not None and not 0.0 < sample_period < float('inf'):
        raise SatvibError(f'--sample-period: {sample_period} is not above 0 s')
    if period is not None and not 0.0 < period < float('inf'):
        raise SatvibError(f'--period: {period} is not above 0 s')
    if low is not None and high is not None and not low < high:
        raise SatvibError(f'--high: {high:g} Hz is not above --low, {low:g} Hz')
    how = _of_options(FrfSettings, {
        'estimator': estimator, 'window': window, 'overlap': overlap, 'resolution': resolution,
        'averages': averages, 'confidence': confidence,
    })  # fmt: skip
    console = make_console()
    if _is_scenario(source):
        moves = {
            'signal': signal, 'low': low, 'high': high, 'duration': duration, 'level': level,
            'coil_level': coil_level, 'period': period, 'direction': _factors(direction),
        }  # fmt: skip
        given = {key: value for key, value in moves.items() if value is not None}
        target, measured = _scenario(console, source, settings, given, how, law, excite, folder)
    else:
        path = Path(source)
        asked = _Asked(
            input_column, output_column, input_unit, output_unit, path_input, time, sample_period
        )
        measured = _of_path(path, how, asked, period, recover)
        if low is not None or high is not None:
            measured = _within(measured, low, high)
        target = free_run_folder(f'{path.resolve().stem}-frf', folder)
        make_run_folder(target)
    mapping = frf_mapping(
        measured.curves, measured.source, measured.notes, measured.coupling, measured.shortfalls,
        measured.warnings,
    )  # fmt: skip
    write_frf(measured.curves, mapping, target)
    show_frf(console, mapping)
    from satvib_experiment.frf.figures import draw_figures

    (target / 'figures').mkdir()
    for drawn in draw_figures(measured.curves, target / 'figures', measured.title):
        console.print(f'figure: {drawn}', soft_wrap=True)
    console.print(f'numbers: {target / "frf.csv"}', soft_wrap=True)


def _factors(text: str | None) -> list[float] | None:
    """Give the factors of a direction as they are typed."""
    from satvib_common.errors import SatvibError

    if text is None:
        return None
    try:
        return [float(part) for part in text.split(',')]
    except ValueError:
        raise SatvibError(f'--direction: {text!r}: numbers with commas are expected') from None


def _of_options(kind: type[_Settings], given: dict[str, Any]) -> _Settings:
    """Make settings of what the options say; what is wrong is named as an option."""
    from satvib_common.errors import SatvibError

    try:
        return kind.from_mapping(given)
    except SatvibError as error:
        keys, _, what = str(error).partition(': ')
        options = ', '.join(f'--{key.replace("_", "-")}' for key in keys.split(', '))
        raise SatvibError(f'{options}: {what}') from None


def _is_scenario(source: str) -> bool:
    """Whether a source is a scenario: a YAML file, or a name that is no file.

    Raises:
        SatvibError: it is a name, and neither a scenario's nor a file's.
    """
    from satvib_common.errors import SatvibError
    from satvib_common.files.suggestions import nearest
    from satvib_experiment.scenario.folder import scenario_names

    path, names = Path(source), scenario_names()
    if path.suffix in {'.yaml', '.yml'}:
        return True
    if path.exists() or path.suffix or '/' in source:
        return False
    if source not in names:
        raise SatvibError(
            f'{source!r}: no such file, folder or scenario; {nearest(source, names)}; ./satvib '
            'scenarios describes them'
        )
    return True


def _scenario(
    console: 'Console',
    source: str,
    changes: list[str] | None,
    moves: dict[str, Any],
    how: 'FrfSettings',
    laws: list[str] | None,
    excite: str,
    folder: Path | None,
) -> tuple[Path, 'Measured']:
    """Measure a scenario by the twin; give the folder that it made, and what it measured."""
    from satvib_experiment.analysis.twin_progress import TwinProgress
    from satvib_experiment.frf.measure import measure_scenario
    from satvib_experiment.frf.measurement import MeasurementSettings
    from satvib_experiment.recording.recording import Recording
    from satvib_experiment.recording.run_folder import free_run_folder, make_run_folder
    from satvib_experiment.scenario.scenario import Scenario, load_scenario
    from satvib_experiment.twin.closed_loop import simulate

    from satvib_bringup.cli.console import ProgressView

    scenario = load_scenario(source, changes or [])
    measurement = _of_options(MeasurementSettings, moves)
    target = free_run_folder(f'{scenario.name}-frf', folder)
    make_run_folder(target)

    def run(made: Scenario) -> Recording:
        law = made.controller.get('law', '')
        title = f'frf {made.name} {law}'.rstrip()
        with ProgressView(console, made.duration, title, every=math.inf) as view:
            return simulate(made, TwinProgress(made, view.update))

    return target, measure_scenario(
        scenario, run, measurement, how, laws or (), EXCITE[excite], target
    )


def _of_path(
    path: Path,
    how: 'FrfSettings',
    asked: '_Asked',
    period: float | None,
    recover: bool,
) -> 'Measured':
    """Measure a file of columns or a recorded run."""
    from satvib_common.records.any_file import has_columns
    from satvib_common.records.layout import Reading
    from satvib_common.records.record import Column, read_columns
    from satvib_common.records.units import ACCELERATION, VOLTAGE
    from satvib_experiment.frf.measure import measure_columns, measure_recording
    from satvib_experiment.recording.load import load_recording

    if has_columns(path, bool(asked.input or asked.output)):
        columns = [
            Column('input', asked.input, VOLTAGE if asked.path else ACCELERATION, asked.input_unit),
            Column('output', asked.output, ACCELERATION, asked.output_unit),
        ]
        reading = Reading(None, None, None, 0, recover)
        record = read_columns(path, columns, asked.sample_period, asked.time, reading)
        names = (str(asked.input), str(asked.output))
        return measure_columns(record, how, names, asked.path, period)
    return measure_recording(load_recording(path, recover), how, period)


def _within(measured: 'Measured', low: float | None, high: float | None) -> 'Measured':
    """Keep a band of every curve."""
    from dataclasses import replace

    from satvib_common.errors import SatvibError

    for option, edge in (('--low', low), ('--high', high)):
        if edge is not None and edge > measured.highest:
            raise SatvibError(
                f'{option}: {edge:g} Hz is above half the sample rate, {measured.highest:g} Hz'
            )
    edges = (low or 0.0, high if high is not None else float('inf'))
    kept = []
    for curve in measured.curves:
        f = curve.measured.frequency
        keep = (f >= edges[0]) & (f <= edges[1])
        if not keep.any():
            raise SatvibError(
                f'--low, --high: no line lies between {edges[0]:g} and {edges[1]:g} Hz'
            )
        kept.append(
            replace(
                curve,
                measured=curve.measured.at_lines(keep),
                exact=None if curve.exact is None else curve.exact[keep],
                model=None if curve.model is None else curve.model[keep],
            )
        )
    return replace(measured, curves=kept)
