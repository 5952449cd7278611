# SPDX-FileCopyrightText: 2026 The satvib authors
# SPDX-License-Identifier: Apache-2.0
"""`satvib campaign`: thousands of closed-loop trials with parameters drawn from distributions."""

from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer

from satvib_bringup.cli.options import Folder

if TYPE_CHECKING:
    from rich.console import Console
    from satvib_studies.campaign.run import Progress


def campaign(
    file: Annotated[
        str | None,
        typer.Argument(
            help='Path of a YAML file, or the name of a campaign that comes with satvib.',
            metavar='FILE',
        ),
    ] = None,
    settings: Annotated[
        list[str] | None,
        typer.Option(
            '--set', help='Change the campaign itself: trials=100, seed=2.', metavar='KEY=VALUE'
        ),
    ] = None,
    folder: Folder = None,
    resume: Annotated[
        Path | None,
        typer.Option('--resume', help='Go on with an interrupted campaign.', metavar='DIR'),
    ] = None,
    redo: Annotated[
        int | None,
        typer.Option('--redo', help='With --resume: run this (damaged) part again.', min=0),
    ] = None,
    scheduler: Annotated[
        str | None,
        typer.Option(
            '--scheduler', help='Run on the workers of a Dask scheduler.', metavar='tls://HOST:PORT'
        ),
    ] = None,
    make_keys: Annotated[
        Path | None,
        typer.Option(
            '--make-keys',
            help='Write keys for a scheduler and its workers into a new file, and end: see docs/campaigns.md.',
            metavar='FILE',
        ),
    ] = None,
    workers: Annotated[
        int | None,
        typer.Option(
            '--workers', '-j', help='Processes of this machine; 0: no other than this.', min=0
        ),
    ] = None,
) -> None:
    """Draw trials, run them on all cores or machines, and report: spread, worst cases, what it depends on.

    Writes trials.parquet, report.html, summary.json and figures/ into a new folder. What is finished is kept whatever
    happens, and `--resume` goes on from there.
    """
    from satvib_common.errors import SatvibError
    from satvib_experiment.recording.run_folder import free_run_folder
    from satvib_studies.campaign.run import begin, go_on
    from satvib_studies.campaign.run import resume as open_again
    from satvib_studies.campaign.settings import load_campaign
    from satvib_studies.campaign.workers import unprotected

    from satvib_bringup.cli.console import make_console

    if make_keys is not None:
        from satvib_studies.campaign.keys import write_keys

        write_keys(make_keys)
        typer.echo(f'{make_keys}: on every machine set DASK_CONFIG to a copy of this file')
        return
    if (file is None) == (resume is None):
        raise SatvibError('campaign: either FILE or --resume DIR is needed')
    if resume is not None:
        for given, name in ((settings, '--set'), (folder, '--folder')):
            if given:
                raise SatvibError(f'campaign: {name} belongs to a new campaign, not to --resume')
        store = open_again(resume, redo)
    else:
        if redo is not None:
            raise SatvibError('campaign: --redo goes with --resume DIR')
        loaded = load_campaign(str(file), settings or [])
        store = begin(loaded, free_run_folder(loaded.name, folder))
    console = make_console()
    if scheduler is not None and (line := unprotected(scheduler)):
        console.print(line, style='yellow')
    try:
        with _bar(console, f'campaign {store.campaign.name}') as progress:
            plan, table = go_on(store, scheduler, workers, progress)
    except KeyboardInterrupt:
        console.print(store.kept(), soft_wrap=True)
        raise
    from satvib_studies.campaign.report.page import write_report  # figures take seconds to import

    summary = write_report(plan, table, store.folder)
    _show(console, summary, store.folder)


class _bar:  # noqa: N801 - used like a function
    """Trials done and the time left; lines where there is no terminal."""

    def __init__(self, console: 'Console', title: str) -> None:
        from rich.progress import (
            BarColumn,
            MofNCompleteColumn,
            Progress,
            TextColumn,
            TimeElapsedColumn,
            TimeRemainingColumn,
        )

        self._console, self._title = console, title
        self._progress = Progress(
            TextColumn('{task.description}', style='bold', markup=False), BarColumn(bar_width=30), MofNCompleteColumn(),
            TextColumn('trials,'), TimeElapsedColumn(), TextColumn('gone,'),
            TimeRemainingColumn(), TextColumn('left'),
            console=console, transient=True, speed_estimate_period=600.0,
        )  # fmt: skip
        self._task = self._progress.add_task(title, total=None)

    def __enter__(self) -> 'Progress':
        if self._console.is_terminal:
            self._progress.start()
        return self._told

    def __exit__(self, *_: object) -> None:
        self._progress.stop()

    def _told(self, done: int, total: int) -> None:
        if self._console.is_terminal:
            self._progress.update(self._task, completed=done, total=total)
        else:
            self._console.print(f'{self._title}: {done} of {total} trials')


def _show(console: 'Console', summary: dict[str, Any], folder: Path) -> None:
    """Print spread, ranking and the worst case."""
    from rich.table import Table
    from satvib_experiment.report.page import number, significant
    from satvib_studies.campaign.report.page import SHOWN

    table = Table(title=f'{summary["campaign"]["name"]}: {summary["trials"]} trials, worst strut')
    for heading in ('', 'least', '5 %', '25 %', 'median', '75 %', '95 %', 'largest'):
        table.add_column(heading, justify='right' if heading else 'left')
    for name, values in summary['spread'].items():
        label, unit = SHOWN[name]
        shown = [number(v, 2, True) if unit == 'dB' else significant(v) for v in values]
        table.add_row(f'{label} [{unit}]'.replace(' []', ''), *shown)
    console.print(table)
    judge = summary['campaign']['judge']
    for item in summary['sensitivity'][:5]:
        if item['share'] is not None:
            console.print(f'• {item["key"]} explains {100 * item["share"]:.0f} % of {judge}')
    if summary['failed']:
        console.print(f'• {summary["failed"]} trials could not run: {summary["errors"][0]}')
    for case in summary['worst'][:1]:
        console.print(f'worst: trial {case["trial"]}, {judge} {significant(case["figure"])}:')
        console.print(f'  {case["command"]}', soft_wrap=True)
    console.print(f'report: {folder / "report.html"}', soft_wrap=True)
