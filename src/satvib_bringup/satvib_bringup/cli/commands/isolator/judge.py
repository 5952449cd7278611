# SPDX-FileCopyrightText: 2026 The satvib authors
# SPDX-License-Identifier: Apache-2.0
"""`satvib judge`: transmissibility and line of sight of every law on every rig, by the offline twin."""

from pathlib import Path
from typing import Annotated

import typer

from satvib_bringup.cli.options import Folder, Jobs, Page, Settings


def judge(
    file: Annotated[
        Path | None,
        typer.Argument(
            help="YAML file of what is judged; the package's own if not given.", metavar='FILE'
        ),
    ] = None,
    rig: Annotated[
        list[str] | None,
        typer.Option('--rig', help='Judge this rig alone; may be given many times.'),
    ] = None,
    law: Annotated[
        list[str] | None,
        typer.Option('--law', help='Judge this law alone; may be given many times.'),
    ] = None,
    settings: Settings = None,
    jobs: Jobs = None,
    page: Page = None,
    folder: Folder = None,
) -> None:
    """Judge laws as isolators: payload over base under random motion, line of sight while a wheel runs up.

    Writes tables.md, judgement.json and a figure of each rig into a new folder. All laws have the same rigs, base
    motions and noises; the first seed has the rig as it is, the others rigs drawn within the tolerances of their parts.
    `--set seeds=2` and `--set measurement.duration=30` take less time.
    """
    import json
    import shutil

    from rich.progress import track
    from satvib_common.errors import SatvibError
    from satvib_common.files.suggestions import nearest
    from satvib_experiment.recording.run_folder import free_run_folder, make_run_folder
    from satvib_studies.isolation.cases import load_isolation
    from satvib_studies.isolation.figure import draw
    from satvib_studies.isolation.runs import run_isolation
    from satvib_studies.isolation.tables import page_tables, plain
    from satvib_studies.sweep.tables import fill

    from satvib_bringup.cli.console import make_console

    loaded = load_isolation(file, settings or [])
    for asked, option, known in ((rig, '--rig', loaded.rigs), (law, '--law', loaded.laws)):
        for name in asked or []:
            if name not in known:
                raise SatvibError(
                    f'{option} {name}: not among what is judged; {nearest(name, list(known))}'
                )
    rigs, laws = list(rig or loaded.rigs), list(law or loaded.laws)
    target = free_run_folder(f'judge-{loaded.name}', folder)
    make_run_folder(target)
    console = make_console()
    found = {
        (one.rig, one.law): one
        for one in track(
            run_isolation(loaded, rigs, laws, jobs),
            description=f'judge {loaded.name}',
            total=len(rigs) * (len(laws) + 1),
            console=console,
            transient=True,
            disable=not console.is_terminal,
        )
    }
    made = page_tables(loaded, found, rigs, laws)
    text = '\n'.join(f'## {mark.removeprefix("judge ")}\n\n{table}' for mark, table in made.items())
    (target / 'tables.md').write_text(text, encoding='utf-8')
    numbers = json.dumps(plain(loaded, found, rigs, laws), indent=1, allow_nan=False)
    (target / 'judgement.json').write_text(numbers + '\n', encoding='utf-8')
    for name in rigs:
        draw(loaded, found, name, laws, target / f'{name}.png')
    if page is not None:
        fill(page, made)
        figures = page.parent / 'figures'
        for name in rigs if figures.is_dir() else ():
            shutil.copy(target / f'{name}.png', figures / f'judge_{name}.png')
    console.print(text, soft_wrap=True)
    console.print(
        f'median (smallest … largest) of {loaded.seeds} seeds; all of it is in {target}',
        soft_wrap=True,
    )
