# SPDX-FileCopyrightText: 2026 The satvib authors
# SPDX-License-Identifier: Apache-2.0
"""`satvib identify`: a model from a measured record."""

from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from satvib_bringup.cli.options import Recover

if TYPE_CHECKING:
    from satvib_common.records.record import MeasuredRecord

NOT_TRUSTED = 3  # exit code: a model is printed, and should not be used


def identify(
    file: Annotated[
        Path,
        typer.Argument(
            help='File of columns (CSV, LVM, TDMS, MAT, HDF5, UFF, WAV, Parquet ...), bag, or folder of a run.',
            metavar='FILE',
        ),
    ],
    input_column: Annotated[
        str | None,
        typer.Option('--input', help='Column of the input; name or number from 1.', metavar='COL'),
    ] = None,
    output_column: Annotated[
        str | None,
        typer.Option(
            '--output', help='Column of the output; name or number from 1.', metavar='COL'
        ),
    ] = None,
    input_unit: Annotated[
        str | None,
        typer.Option(
            '--input-unit',
            help="V, mV ..., or a factor and a unit, '0.1 V'; else as the file says, or V.",
            metavar='UNIT',
        ),
    ] = None,
    output_unit: Annotated[
        str | None,
        typer.Option(
            '--output-unit',
            help='m/s^2, g, mm/s^2 ..., also with a factor; else as the file says, or m/s^2.',
            metavar='UNIT',
        ),
    ] = None,
    time: Annotated[
        str | None,
        typer.Option('--time', help='Time column; found by its name otherwise.', metavar='COL'),
    ] = None,
    strut: Annotated[int, typer.Option('--strut', help='Run: which strut, from 1.', min=1)] = 1,
    order: Annotated[
        list[int] | None,
        typer.Option(
            '--order', help='Poles, n; many times: orders to compare. Without it: 1 to 8.'
        ),
    ] = None,
    coefficients: Annotated[
        int | None,
        typer.Option('--coefficients', help='Input coefficients, m; n + 1 if not given.', min=1),
    ] = None,
    delay: Annotated[
        int | None,
        typer.Option(
            '--delay',
            help='Samples from an input to its first output; searched, of a run 1.',
            min=0,
        ),
    ] = None,
    sample_period: Annotated[
        float | None,
        typer.Option(
            '--sample-period', help='s; otherwise from the time column or the file, or a second.'
        ),
    ] = None,
    separator: Annotated[
        str | None,
        typer.Option(
            '--separator',
            help='Text: comma, semicolon, tab, bar, blanks or a character; else found out.',
        ),
    ] = None,
    decimal: Annotated[
        str | None, typer.Option('--decimal', help="Text: '.' or ','; found out otherwise.")
    ] = None,
    encoding: Annotated[
        str | None,
        typer.Option('--encoding', help='Text: as in utf-16 or latin-1; found out otherwise.'),
    ] = None,
    recover: Recover = False,
    skip: Annotated[
        int, typer.Option('--skip', help='Text: lines to leave out at the start.', min=0)
    ] = 0,
    method: Annotated[
        str, typer.Option('--method', help='least_squares, extended or instrumental.')
    ] = 'least_squares',
    criterion: Annotated[
        str, typer.Option('--criterion', help='Chooses the order: validation, bic or aic.')
    ] = 'validation',
    save: Annotated[
        Path | None, typer.Option('--save', help='Write the model as YAML.', metavar='FILE')
    ] = None,
    plots: Annotated[
        Path | None,
        typer.Option(
            '--plots', help='Draw fit, residual, poles and zeros, Bode.', metavar='FOLDER'
        ),
    ] = None,
) -> None:
    """Identify a model of a record; compare orders, say which one and why, and whether it may be trusted.

    Exit code: 0 nothing speaks against the model, 3 a model is printed that should not be used (the findings say why
    and what to do), 2 the input is wrong.
    """
    from satvib_common.errors import SatvibError
    from satvib_common.records.any_file import has_columns
    from satvib_common.records.layout import Reading
    from satvib_common.records.record import column_record
    from satvib_experiment.recording.strut_record import read_strut

    from satvib_bringup.cli.console import make_console
    from satvib_bringup.cli.identification_view import show_identification, show_progress

    if sample_period is not None and not 0.0 < sample_period < float('inf'):
        raise SatvibError(f'--sample-period: {sample_period} is not above 0 s')
    for wanted in order or []:
        if wanted < 1:
            raise SatvibError(f'--order: {wanted} is less than 1')
    for target in (save, plots):
        if target is not None and target.exists():
            raise SatvibError(f'{target}: exists already, not overwritten')
    if has_columns(file, bool(input_column or output_column)):
        memory = max(order or [8]) + (coefficients or 0) + (delay or 0) + 200
        record = column_record(
            file,
            input_column,
            output_column,
            sample_period,
            time,
            Reading(separator, decimal, encoding, skip, recover),
            memory,
            (input_unit, output_unit),
        )
    else:
        record = read_strut(file, strut, recover)

    from satvib_ident.models.model_file import save_model
    from satvib_ident.offline.order_search import identify as identify_offline
    from satvib_ident.offline.plots import save_plots

    console = make_console()
    late, notes = _delay(record, delay)
    orders = [(n, coefficients or n + 1, late) for n in order or range(1, 9)]
    try:
        with show_progress(console, f'identify {record.name}') as progress:
            result = identify_offline(
                record.y, record.u, record.dt, orders, method, criterion, progress=progress
            )
    except SatvibError as error:
        raise SatvibError(f'{record.name}: {error}') from None
    show_identification(console, result, record.name, [*record.notes, *notes])
    if save is not None:
        save_model(
            save,
            result.model,
            {**result.about(), 'record': record.name, 'notes': [*record.notes, *notes]},
        )
        console.print(f'model: {save}', soft_wrap=True)
    if plots is not None:
        save_plots(result, plots)
        console.print(f'plots: {plots}', soft_wrap=True)
    if not result.trusted:
        raise typer.Exit(NOT_TRUSTED)


def _delay(record: 'MeasuredRecord', told: int | None) -> tuple[int, list[str]]:
    """The delay of a record and the evidence for it."""
    from satvib_common.errors import SatvibError
    from satvib_ident.offline.delay import find_delay

    if told is not None:
        return told, []
    if record.delay is not None:
        return record.delay, []
    try:
        found = find_delay(record.y, record.u)
    except SatvibError as error:
        raise SatvibError(f'{record.name}: {error}') from None
    return (
        (found.delay, [str(found)])
        if found is not None
        else (0, ['delay 0: the record is too short to search it'])
    )
