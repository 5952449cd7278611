# SPDX-FileCopyrightText: 2026 The satvib authors
# SPDX-License-Identifier: Apache-2.0
"""`satvib report`: the report of a bag or of a simulated run."""

from functools import partial
from pathlib import Path
from typing import Annotated

import typer

from satvib_bringup.cli.options import Recover


def report(
    source: Annotated[
        Path,
        typer.Argument(
            help="A run's folder, a bag's folder, an .mcap or .db3 file, or a recording.npz.",
            metavar='BAG',
        ),
    ],
    output: Annotated[
        Path | None,
        typer.Option(
            '--output', '-o', help='Where to. Without it: <name of the bag>-report.', metavar='DIR'
        ),
    ] = None,
    recover: Recover = False,
) -> None:
    """Write report.html, result.json and figures/ of a recorded run, and print its table.

    What is missing in the recording is said, and the rest is reported. A recording that was cut short is read as far as
    it goes; one with damaged bytes is refused without --recover.

    Exit code 3: the run is no result (no CONTROL, no disturbance, no trusted model, no voltage under control, more than
    1 % late).
    """
    from satvib_experiment.recording.load import load_recording
    from satvib_experiment.report.build import refuse_existing, write_report
    from satvib_experiment.report.drawing import Drawing

    from satvib_bringup.cli.console import NO_RESULT, make_console, show_page, show_result

    source = source.resolve()
    name = source.name if source.is_dir() else source.stem
    folder = output or source.parent / f'{name}-report'
    refuse_existing(folder)
    console = make_console()
    with Drawing() as drawing:
        recording = load_recording(source, recover)
        written = write_report(recording, folder, drawing, partial(show_result, console))
    show_page(console, written.page)
    if written.result['shortfalls']:
        raise typer.Exit(NO_RESULT)
