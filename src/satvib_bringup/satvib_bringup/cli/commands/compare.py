# SPDX-FileCopyrightText: 2026 The satvib authors
# SPDX-License-Identifier: Apache-2.0
"""`satvib compare`: the centralized against the decentralized scheme, when all is well and when things go wrong."""

from typing import Annotated

import typer

from satvib_bringup.cli.options import Folder, Page, Settings


def compare(
    file: Annotated[
        str,
        typer.Argument(
            help='schemes, hexapod, or the path of the YAML file of a comparison.', metavar='FILE'
        ),
    ] = 'schemes',
    settings: Settings = None,
    page: Page = None,
    folder: Folder = None,
) -> None:
    """Compare control schemes on the same rigs, disturbances and seeds, through failures and changes.

    Writes tables.md, comparison.json, comparison.png and, as a scenario that can be run live, the first seed of every
    cell into a new folder; `--set seeds=20`, `--set event=12`, `--set base.rig=clean_3dof` and so on change what is
    compared.
    """
    import json
    import shutil

    from rich.progress import BarColumn, Progress, TextColumn, TimeElapsedColumn
    from satvib_experiment.recording.run_folder import (
        free_run_folder,
        make_run_folder,
        write_scenario,
    )
    from satvib_studies.comparison.cases import load_comparison, replayable
    from satvib_studies.comparison.figure import draw
    from satvib_studies.comparison.runs import run_comparison
    from satvib_studies.comparison.tables import plain, tables
    from satvib_studies.sweep.tables import fill

    from satvib_bringup.cli.console import make_console

    loaded = load_comparison(file, settings or [])
    target = free_run_folder(f'compare-{loaded.name}', folder)
    make_run_folder(target)
    console = make_console()
    with Progress(
        TextColumn('[bold]compare'), BarColumn(bar_width=24), TextColumn('{task.fields[status]}', markup=False),
        TimeElapsedColumn(), console=console, transient=True, disable=not console.is_terminal,
    ) as bar:  # fmt: skip
        task = bar.add_task('compare', total=1 + len(loaded.schemes), status='')
        done: dict[str, float] = {}

        def report(scheme: str, sample: int, samples: int) -> None:
            done[scheme] = sample / samples
            bar.update(task, completed=sum(done.values()), status=scheme)

        found = run_comparison(loaded, report)
    made = tables(found)
    text = '\n'.join(made.values())
    (target / 'tables.md').write_text(text, encoding='utf-8')
    numbers = json.dumps(plain(found), indent=1, allow_nan=False)
    (target / 'comparison.json').write_text(numbers + '\n', encoding='utf-8')
    draw(found, target / 'comparison.png')
    for scheme in loaded.schemes:
        for case in loaded.cases:
            cell = target / 'scenarios' / f'{scheme}-{case}'
            make_run_folder(cell)
            write_scenario(replayable(loaded, scheme, case, loaded.seed), cell)
    if page is not None:
        fill(page, made)
        figures = page.parent / 'figures'
        if figures.is_dir():
            name = 'comparison' if loaded.name == 'schemes' else f'comparison_{loaded.name}'
            shutil.copy(target / 'comparison.png', figures / f'{name}.png')
    console.print(text, soft_wrap=True)
    trials = len(loaded.cases) * loaded.seeds
    console.print(
        f'dB against 0 V: median (best … worst) of {loaded.seeds} seeds; {trials} trials per scheme; '
        f'all of it is in {target}',
        soft_wrap=True,
    )
