# SPDX-FileCopyrightText: 2026 The satvib authors
# SPDX-License-Identifier: Apache-2.0
"""`satvib run` and `satvib demo`: a scenario as a live ROS 2 graph, recorded and reported."""

import contextlib
from collections.abc import Callable
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer
from satvib_common.errors import RunError, SatvibError

from satvib_bringup.cli.options import Folder, ScenarioName, Settings

if TYPE_CHECKING:
    from satvib_bringup.live.progress import Outcome

Realtime = Annotated[
    bool,
    typer.Option(
        '--realtime', help='At the pace of the clock, instead of in lockstep as fast as it goes.'
    ),
]
Composition = Annotated[
    str,
    typer.Option(
        '--composition',
        help='A process for each node (separate), for each strut (strut), or one for all (single). '
        'Without it: as the scenario says.',
        metavar='separate|strut|single',
    ),
]
Watch = Annotated[
    bool,
    typer.Option('--watch', help='Show the run as a web page on this machine while it goes on.'),
]


def demo(
    settings: Settings = None,
    folder: Folder = None,
    realtime: Realtime = False,
    composition: Composition = '',
) -> None:
    """The paper's 3-DOF experiment, live, then beside the laws of this project and an acquisition built for the job.

    The paper's part is a graph of processes with a bag; the others are simulated, with the same seed. One table and one
    report show them beside one another.
    """
    _run('paper_3dof', settings, folder, realtime, composition, beside=True)


def run(
    scenario: ScenarioName,
    settings: Settings = None,
    folder: Folder = None,
    realtime: Realtime = False,
    composition: Composition = '',
    watch: Watch = False,
) -> None:
    """Run a scenario as a live graph of processes, record it to a bag, and report.

    Writes bag/, logs, scenario.yaml, report.html, result.json and figures/ into a new folder.

    Exit code 3: the run is no result (no CONTROL, no disturbance, no trusted model, no voltage under control, more than
    1 % late).
    """
    _run(scenario, settings, folder, realtime, composition, watch=watch)


def _run(
    name: str,
    settings: list[str] | None,
    folder: Path | None,
    realtime: bool,
    composition: str,
    beside: bool = False,
    watch: bool = False,
) -> None:
    from satvib_experiment.recording.bag_reader import read_recording
    from satvib_experiment.recording.run_folder import free_run_folder, write_scenario
    from satvib_experiment.report.build import write_report
    from satvib_experiment.report.comparison import simulated_rows
    from satvib_experiment.report.drawing import Drawing
    from satvib_experiment.scenario.scenario import load_scenario

    from satvib_bringup.cli.console import (
        NO_RESULT,
        ProgressView,
        make_console,
        show_comparison,
        show_page,
        show_result,
    )

    scenario = load_scenario(name, settings or [])
    target = free_run_folder(scenario.name, folder)
    run_experiment = _experiment()
    console = make_console()
    from satvib_common.transport.reach import set_transport, warning

    if line := warning(set_transport()):
        console.print(line, style='yellow')
    with contextlib.ExitStack() as page:
        if watch:
            from satvib_bringup.watch.live.beside import page_beside

            console.print(f'watch it: {page.enter_context(page_beside())}')
        view = page.enter_context(ProgressView(console, scenario.duration, f'run {scenario.name}'))
        outcome = run_experiment(
            scenario,
            target,
            realtime=realtime,
            record=True,
            progress=lambda p: view.update(p.phase, p.time, p.attenuation),
            composition=composition,
        )
    write_scenario(scenario, target)
    if not outcome.success:
        error = SatvibError if outcome.exit_code == 2 else RunError
        raise error(f'{outcome.message}; logs and what was recorded are in {target}')
    console.print(outcome.message, style='dim')
    with Drawing() as drawing:
        show = partial(show_comparison if beside else show_result, console)
        others = partial(simulated_rows, settings=[f'seed={scenario.seed}']) if beside else None
        report = write_report(read_recording(target), target, drawing, show, others)
    show_page(console, report.page)
    if report.result['shortfalls']:
        raise typer.Exit(NO_RESULT)


def _experiment() -> 'Callable[..., Outcome]':
    """Give `run_experiment`, which needs ROS and the built workspace.

    Raises:
        SatvibError: one of them is not there.
    """
    try:
        from satvib_bringup.live.run import run_experiment
    except ModuleNotFoundError as error:
        raise SatvibError(
            f'the module {error.name} is not there: a live run needs the built workspace; start '
            'it as ./satvib, or source install/setup.bash first (`satvib simulate` needs no ROS)'
        ) from None
    return run_experiment
