# SPDX-FileCopyrightText: 2026 The satvib authors
# SPDX-License-Identifier: Apache-2.0
"""`satvib identify`: a model from a measured record."""

from pathlib import Path
from typing import Annotated

import typer


def identify(
    file: Annotated[
        Path,
        typer.Argument(
            help='CSV file with a header line, or the bag or folder of a run.', metavar='FILE'
        ),
    ],
    input_column: Annotated[
        str | None, typer.Option('--input', help='CSV: column of the input, V.', metavar='COL')
    ] = None,
    output_column: Annotated[
        str | None,
        typer.Option('--output', help='CSV: column of the output, m/s^2.', metavar='COL'),
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
            '--delay', help='Samples from an input to its first output; 0, of a run 1.', min=0
        ),
    ] = None,
    sample_period: Annotated[
        float | None,
        typer.Option('--sample-period', help='CSV: s; without it a sample is a second.'),
    ] = None,
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
    """Identify a model of a record by recursive estimation; compare orders, and say which one and why."""
    from satvib_common.errors import SatvibError
    from satvib_experiment.recording.input_output import read_csv, read_strut

    from satvib_bringup.cli.console import make_console
    from satvib_bringup.cli.identification_view import show_identification

    if sample_period is not None and not sample_period > 0.0:
        raise SatvibError(f'--sample-period: {sample_period} is not above 0 s')
    for wanted in order or []:
        if wanted < 1:
            raise SatvibError(f'--order: {wanted} is less than 1')
    for target in (save, plots):
        if target is not None and target.exists():
            raise SatvibError(f'{target}: exists already, not overwritten')
    if file.suffix.lower() in {'.csv', '.tsv', '.txt'}:
        record = read_csv(file, input_column, output_column, sample_period)
    else:
        record = read_strut(file, strut)
    late = record.delay if delay is None else delay
    orders = [(n, coefficients or n + 1, late) for n in order or range(1, 9)]

    from satvib_ident.models.model_file import save_model
    from satvib_ident.offline.order_search import identify as identify_offline
    from satvib_ident.offline.plots import save_plots

    try:
        result = identify_offline(record.y, record.u, record.dt, orders, method, criterion)
    except SatvibError as error:
        raise SatvibError(f'{record.name}: {error}') from None
    console = make_console()
    show_identification(console, result, record.name)
    if save is not None:
        save_model(save, result.model, {**result.about(), 'record': record.name})
        console.print(f'model: {save}', soft_wrap=True)
    if plots is not None:
        save_plots(result, plots)
        console.print(f'plots: {plots}', soft_wrap=True)
