# SPDX-FileCopyrightText: 2026 The satvib authors
# SPDX-License-Identifier: Apache-2.0
"""`satvib identify`: a model from a measured record."""

from pathlib import Path
from typing import Annotated

import typer


def identify(
    file: Annotated[Path, typer.Argument(help='CSV file with a header line.', metavar='FILE')],
    input_column: Annotated[
        str, typer.Option('--input', help='Column of the input, V.', metavar='COL')
    ],
    output_column: Annotated[
        str, typer.Option('--output', help='Column of the output, m/s^2.', metavar='COL')
    ],
    order: Annotated[int, typer.Option('--order', help='Number of poles, n.', min=1, max=20)] = 2,
    coefficients: Annotated[
        int | None,
        typer.Option('--coefficients', help='Number of input coefficients, m; n + 1 if not given.'),
    ] = None,
    delay: Annotated[
        int, typer.Option('--delay', help='Samples from an input to its first output.', min=0)
    ] = 0,
    sample_period: Annotated[
        float, typer.Option('--sample-period', help='s; for poles in Hz and damping.')
    ] = 1.0,
    save: Annotated[
        Path | None, typer.Option('--save', help='Write the model as YAML.', metavar='FILE')
    ] = None,
) -> None:
    """Identify a model by recursive least squares and print it, its poles and its fits."""
    from satvib_common.errors import SatvibError

    from satvib_bringup.console import make_console
    from satvib_bringup.csv_record import read_columns
    from satvib_bringup.offline_identification import identify_record, show_model

    if not sample_period > 0.0:
        raise SatvibError(f'--sample-period: {sample_period} is not above 0 s')
    u, y = read_columns(file, [input_column, output_column])
    found = identify_record(u, y, sample_period, order, coefficients or order + 1, delay)
    show_model(make_console(), found, file.name)
    if save is not None:
        from satvib_ident.model_file import save_model

        save_model(save, found.model)
