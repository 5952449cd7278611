# SPDX-FileCopyrightText: 2026 The satvib authors
# SPDX-License-Identifier: Apache-2.0
"""Arguments and options that several commands share."""

from pathlib import Path
from typing import Annotated

import typer

ScenarioName = Annotated[
    str,
    typer.Argument(
        help='Name of a scenario (see `satvib scenarios`), or the path of its YAML file.',
        metavar='SCENARIO',
    ),
]
Settings = Annotated[
    list[str] | None,
    typer.Option(
        '--set',
        help='Change a setting, with dots for nested keys: seed=7, '
        'controller.law=velocity_feedback, rig.payload.mass=12. May be given many times.',
        metavar='KEY=VALUE',
    ),
]
Folder = Annotated[
    Path | None,
    typer.Option(
        '--folder',
        '--record',
        help='New folder of the run. Without it: runs/NAME-NUMBER.',
        metavar='DIR',
    ),
]
Recover = Annotated[
    bool,
    typer.Option(
        '--recover',
        help='Bag, LVM, TDMS, WAV: read what can be read of one that is damaged or cut.',
    ),
]
Jobs = Annotated[
    int | None, typer.Option('--jobs', '-j', help='Processes; all cores if not given.', min=1)
]
Page = Annotated[
    Path | None,
    typer.Option('--page', help='Write the tables between the marks of this Markdown page, too.'),
]
