# SPDX-FileCopyrightText: 2026 The satvib authors
# SPDX-License-Identifier: Apache-2.0
"""`satvib simulate`: the offline twin of a live run, in one process."""

from functools import partial

import typer

from satvib_bringup.cli.options import Folder, ScenarioName, Settings


def simulate(scenario: ScenarioName, settings: Settings = None, folder: Folder = None) -> None:
    """Run a scenario in this process, without DDS: sample for sample what the lockstep graph does.

    Writes recording.npz, scenario.yaml, report.html, result.json and figures/ into a new folder.

    Exit code 3: the run is no result (no CONTROL, no disturbance, no trusted model, no voltage under control).
    """
    from satvib_experiment.analysis.twin_progress import TwinProgress
    from satvib_experiment.recording.run_folder import (
        free_run_folder,
        make_run_folder,
        write_scenario,
    )
    from satvib_experiment.report.build import write_report
    from satvib_experiment.report.drawing import Drawing
    from satvib_experiment.scenario.scenario import load_scenario
    from satvib_experiment.twin.closed_loop import simulate as run_twin

    from satvib_bringup.cli.console import (
        NO_RESULT,
        ProgressView,
        make_console,
        show_page,
        show_result,
    )

    loaded = load_scenario(scenario, settings or [])
    target = free_run_folder(loaded.name, folder)
    make_run_folder(target)
    write_scenario(loaded, target)
    console = make_console()
    with Drawing() as drawing:
        with ProgressView(console, loaded.duration, f'simulate {loaded.name}') as view:
            recording = run_twin(loaded, TwinProgress(loaded, view.update))
            elapsed = view.elapsed
        recording.save(target / 'recording.npz')
        report = write_report(recording, target, drawing, partial(show_result, console))
    show_page(console, report.page)
    console.print(
        f'simulated {loaded.duration:g} s in {elapsed:.1f} s, '
        f'{loaded.duration / elapsed:.0f} times real time',
        style='dim',
    )
    if report.result['shortfalls']:
        raise typer.Exit(NO_RESULT)
