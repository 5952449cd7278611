# SPDX-FileCopyrightText: 2026 The satvib authors
# SPDX-License-Identifier: Apache-2.0
"""`satvib table`: laws x rigs x disturbances by the offline twin, as tables."""

from pathlib import Path
from typing import Annotated

import typer

from satvib_bringup.cli.options import Folder, Jobs, Settings


def table(
    sweep: Annotated[
        str, typer.Argument(help='Name of a sweep, or the path of its YAML file.', metavar='SWEEP')
    ] = 'laws',
    only: Annotated[
        list[str] | None,
        typer.Option('--only', help='Keep the cells with this label; may be given many times.'),
    ] = None,
    settings: Settings = None,
    jobs: Jobs = None,
    page: Annotated[
        list[Path] | None,
        typer.Option(
            '--page',
            help='Write the tables between the marks of this Markdown page, too; may be given many times.',
        ),
    ] = None,
    folder: Folder = None,
) -> None:
    """Run every law on every rig under every disturbance, and print and write the tables.

    Attenuation is against the open-loop twin in the same instants; of several struts the worst is shown.
    """
    import json
    import shutil

    from rich.markup import escape
    from rich.progress import track
    from satvib_common.errors import SatvibError
    from satvib_experiment.recording.run_folder import free_run_folder, make_run_folder
    from satvib_studies.sweep.figure import draw
    from satvib_studies.sweep.sweep import load_sweep, run_sweep
    from satvib_studies.sweep.tables import fill, markdown, summary

    from satvib_bringup.cli.console import make_console

    loaded = load_sweep(sweep, settings)
    cells = loaded.cells()
    for name in only or []:
        cells = [c for c in cells if name in c.labels.values()]
        if not cells:
            raise SatvibError(f'--only {name}: no cell is left')
    target = free_run_folder(f'table-{loaded.name}', folder)
    make_run_folder(target)
    console = make_console()
    rows = dict(
        track(
            run_sweep(cells, jobs),
            description=escape(f'table {loaded.name}'),
            total=len(cells),
            console=console,
            transient=True,
            disable=not console.is_terminal,
        )
    )
    ordered = [rows[i] for i in range(len(cells))]
    text = markdown(ordered)
    (target / 'table.md').write_text(text, encoding='utf-8')
    (target / 'table.json').write_text(json.dumps(ordered, indent=1, allow_nan=False) + '\n')
    if loaded.figure is not None:
        draw(ordered, loaded.figure, target / 'table.png')
    tables = {f'table {loaded.name}': text}
    if loaded.summary is not None:
        tables[f'summary {loaded.name}'] = summary(ordered, loaded.summary)
    for path in page or []:
        fill(path, tables)
        figures = path.parent / 'figures'
        if loaded.figure is not None and figures.is_dir():
            shutil.copy(target / 'table.png', figures / f'{loaded.name}.png')
    console.print(text, soft_wrap=True)
    console.print(f'{len(ordered)} cells; the tables are in {target}')
