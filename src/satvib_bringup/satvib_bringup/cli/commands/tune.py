# SPDX-FileCopyrightText: 2026 The satvib authors
# SPDX-License-Identifier: Apache-2.0
"""`satvib tune`: gains of the centralized law, an LQG design, or a fixed notch, by particle swarm."""

from enum import StrEnum
from pathlib import Path
from typing import Annotated, Any

import typer

from satvib_bringup.cli.options import Folder, Settings

RigName = Annotated[
    str, typer.Option('--rig', help='Name of a rig (see `satvib rigs`), or the path of its file.')
]
DisturbanceText = Annotated[
    str,
    typer.Option(
        '--disturbance',
        help="What shakes it: YAML as in '{kind: sine, frequency: 9, amplitude: 0.5}', a YAML file, "
        'or the name of a scenario.',
    ),
]


class Design(StrEnum):
    """What is tuned."""

    PID = 'pid'
    LQG = 'lqg'
    NOTCH = 'notch'


DesignName = Annotated[
    Design,
    typer.Option(
        '--design',
        help='pid: gains of the centralized law; lqg: weights and noises of an LQG design for all struts; notch: a '
        'damper with a fixed notch for each strut. Both run as law state_space.',
    ),
]
Checkpoint = Annotated[
    Path | None,
    typer.Option(
        '--checkpoint',
        help='File that keeps the state of the search; one that is there already is gone on from.',
    ),
]


def tune(
    rig: RigName,
    disturbance: DisturbanceText,
    design: DesignName = Design.PID,
    settings: Settings = None,
    folder: Folder = None,
    checkpoint: Checkpoint = None,
) -> None:
    """Find gains of the centralized law for a rig and a disturbance, good on all of a set of perturbed plants.

    Writes gains.yaml, with the cost's history, and tuning.png into a new folder. `--set rig.payload.mass=12` changes
    the rig, `--set swarm.budget=20000` and `--set cost.margin=0.4` the search. `--design lqg` and `--design notch` find
    other fixed controllers, by the same cost on the same plants.
    """
    from rich.progress import BarColumn, Progress, TextColumn, TimeRemainingColumn
    from satvib_common.settings_text import change_settings
    from satvib_experiment.recording.run_folder import free_run_folder, make_run_folder
    from satvib_plant_sim.rig.any_rig import load_any_rig
    from satvib_studies.tuning.search import read_disturbance

    from satvib_bringup.cli.console import make_console

    data: dict[str, Any] = {}
    change_settings(data, settings or [])
    loaded = load_any_rig(rig, data.pop('rig_overrides', None))
    search = _search(design, loaded, read_disturbance(disturbance), data)
    if checkpoint is not None:
        search.check(checkpoint)
    target = free_run_folder(f'tune-{loaded.name}', folder)
    make_run_folder(target)
    console = make_console()
    budget = search.settings.swarm.budget
    with Progress(
        TextColumn('[bold]tune'), BarColumn(bar_width=24), TextColumn('{task.fields[status]}', markup=False),
        TimeRemainingColumn(), console=console, transient=True, disable=not console.is_terminal,
    ) as bar:  # fmt: skip
        task = bar.add_task('tune', total=budget, status='')

        def report(swarm: Any) -> None:
            status = (
                f'{swarm.evaluations} of {budget} evaluations, best cost {swarm.cost_found:.5g}'
            )
            bar.update(task, completed=swarm.evaluations, status=status)
            if not console.is_terminal and swarm.steps % 25 == 0:
                console.print(f'tune: {status}')

        found = search.run(report, checkpoint)
    console.print(_table(search, _write(found, target)))
    console.print(
        f'ended by {found.result.reason} after {found.result.evaluations} evaluations; '
        f'gains: {target / "gains.yaml"}, figure: {target / "tuning.png"}',
        soft_wrap=True,
    )


def _search(design: Design, rig: Any, disturbance: dict[str, Any], settings: dict[str, Any]) -> Any:
    if design is Design.PID:
        from satvib_studies.tuning.search import Search, TuneSettings

        return Search(rig, disturbance, TuneSettings.from_mapping(settings, '--set'))
    from satvib_studies.design.search import DesignSearch, DesignSettings

    settings = {**settings, 'design': design.value}
    return DesignSearch(rig, disturbance, DesignSettings.from_mapping(settings, '--set'))


def _write(found: Any, folder: Path) -> dict[str, dict[str, float]]:
    """Write gains.yaml and tuning.png; gives what is worth telling."""
    from satvib_studies.tuning.search import Tuned

    if isinstance(found, Tuned):
        from satvib_studies.tuning.figure import draw
        from satvib_studies.tuning.search import summary, write_gains

        write_gains(found, folder / 'gains.yaml')
        draw(found, folder / 'tuning.png')
        return summary(found)
    from satvib_studies.design.search import draw_design, write_design

    write_design(found, folder / 'gains.yaml')
    draw_design(found, folder / 'tuning.png')
    rows: dict[str, dict[str, float]] = found.summary()
    return rows


def _table(search: Any, figures: dict[str, dict[str, float]]) -> Any:
    from rich.table import Table
    from satvib_studies.tuning.search import UNTUNED, Search

    untuned = (
        f'P = {UNTUNED:.1f} V/(m/s)' if isinstance(search, Search) else 'where the search began'
    )
    table = Table(
        title=f'{search.rig.name}: payload against 0 V on {len(search.cost.plants)} plants; untuned: {untuned}'
    )
    columns = (
        '',
        'cost',
        'attenuation\ndB',
        'worst plant\ndB',
        'voltage\nV RMS',
        'margin',
        'worst\nmargin',
    )
    for name in columns:
        table.add_column(name, justify='right')
    for name, row in figures.items():
        cost, nominal, worst, volts, margin, least = list(row.values())[:6]
        table.add_row(
            name, f'{cost:.4f}', f'{nominal:+.1f}', f'{worst:+.1f}', f'{volts:.2f}',
            f'{margin:.2f}', f'{least:.2f}',
        )  # fmt: skip
    return table
