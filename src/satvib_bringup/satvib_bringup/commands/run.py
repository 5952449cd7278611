# SPDX-FileCopyrightText: 2026 The satvib authors
# SPDX-License-Identifier: Apache-2.0
"""`satvib run` and `satvib demo`: a scenario as a live ROS 2 graph, recorded and reported."""

from pathlib import Path
from typing import Annotated

import typer
from satvib_common.errors import RunError

from satvib_bringup.commands.options import Folder, ScenarioName, Settings

Realtime = Annotated[
    bool,
    typer.Option(
        '--realtime', help='At the pace of the clock, instead of in lockstep as fast as it goes.'
    ),
]


def demo(
    settings: Settings = None,
    folder: Folder = None,
    realtime: Realtime = False,
) -> None:
    """The paper's 3-DOF experiment, live: one plant, three identifiers, three controllers, a bag, a report."""
    _run('paper_3dof', settings, folder, realtime)


def run(
    scenario: ScenarioName,
    settings: Settings = None,
    folder: Folder = None,
    realtime: Realtime = False,
) -> None:
    """Run a scenario as a live graph of processes, record it to a bag, and report.

    Writes bag/, logs, scenario.yaml, report.html, result.json and figures/ into a new folder.
    """
    _run(scenario, settings, folder, realtime)


def _run(name: str, settings: list[str] | None, folder: Path | None, realtime: bool) -> None:
    from satvib_bringup.bag import read_recording
    from satvib_bringup.console import ProgressView, make_console, show_result
    from satvib_bringup.experiment import run_experiment
    from satvib_bringup.report import write_report
    from satvib_bringup.run_folder import new_run_folder, write_scenario
    from satvib_bringup.scenario import load_scenario

    scenario = load_scenario(name, settings or [])
    target = new_run_folder(scenario.name, folder)
    write_scenario(scenario, target)
    console = make_console()
    with ProgressView(console, scenario.duration, f'run {scenario.name}') as view:
        outcome = run_experiment(
            scenario,
            target,
            realtime=realtime,
            record=True,
            progress=lambda p: view.update(p.phase, p.time, p.attenuation),
        )
        elapsed = view.elapsed
    if not outcome.success:
        raise RunError(f'{outcome.message}; what was recorded is in {target}')
    report = write_report(read_recording(target), target)
    show_result(console, report.result, report.page)
    console.print(
        f'ran {scenario.duration:g} s in {elapsed:.1f} s, '
        f'{scenario.duration / elapsed:.1f} times real time, start and stop included',
        style='dim',
    )
