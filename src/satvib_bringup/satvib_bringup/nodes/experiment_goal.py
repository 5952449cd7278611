# SPDX-FileCopyrightText: 2026 The satvib authors
# SPDX-License-Identifier: Apache-2.0
"""One goal of the experiment server: the run and its report, in a thread, so that the server goes on answering."""

import threading
from collections.abc import Sequence
from dataclasses import dataclass, field
from pathlib import Path

from satvib_common.errors import RunError, SatvibError
from satvib_experiment.recording.bag_reader import read_recording
from satvib_experiment.recording.run_folder import free_run_folder, write_scenario
from satvib_experiment.report.build import write_report
from satvib_experiment.scenario.scenario import load_scenario

from satvib_bringup.live.progress import Progress
from satvib_bringup.live.run import run_experiment

KINDS = ('measured_rms', 'measured_tone', 'true_rms', 'true_tone')


@dataclass
class GoalResult:
    """What the client gets.

    Attributes:
        success: the run and its report are complete, and the run is a result.
        message: one line; of a run that is no result, why.
        folder: of the run.
        struts: names.
        attenuation: dB per strut, by kind.
    """

    success: bool = False
    message: str = ''
    folder: str = ''
    struts: tuple[str, ...] = ()
    attenuation: dict[str, list[float]] = field(default_factory=dict)


class ExperimentGoal:
    """A run in a thread.

    Args:
        scenario: name or path.
        overrides: 'key=value' each.
        realtime: samples follow the clock.
        folder: of the run; empty: the next free one below `runs`.
        runs: where numbered runs go.
    """

    def __init__(
        self, scenario: str, overrides: Sequence[str], realtime: bool, folder: str, runs: Path
    ) -> None:
        self.result = GoalResult()
        self.progress: Progress | None = None
        self._cancel = threading.Event()
        arguments = (scenario, tuple(overrides), realtime, folder, runs)
        # the processes of a run end with the thread that started them, so it stays until they are gone
        self._thread = threading.Thread(target=self._work, args=arguments, name='experiment')
        self._thread.start()

    @property
    def cancelled(self) -> bool:
        """Whether it was asked to end early."""
        return self._cancel.is_set()

    def done(self) -> bool:
        """Whether everything has ended."""
        return not self._thread.is_alive()

    def cancel(self) -> None:
        """End the run early; it is over when `done` says so."""
        self._cancel.set()

    def join(self) -> None:
        """Wait for the end."""
        self._thread.join()

    def _work(
        self, name: str, overrides: Sequence[str], realtime: bool, folder: str, runs: Path
    ) -> None:
        try:
            self._run(name, overrides, realtime, folder, runs)
        except (SatvibError, RunError) as error:
            self.result.message = str(error)
        except Exception as error:  # noqa: BLE001 - the client gets every error
            self.result.message = f'{type(error).__name__}: {error}'

    def _run(
        self, name: str, overrides: Sequence[str], realtime: bool, folder: str, runs: Path
    ) -> None:
        scenario = load_scenario(name, overrides)
        target = free_run_folder(scenario.name, Path(folder) if folder else None, runs)
        result = self.result
        outcome = run_experiment(
            scenario, target, realtime, progress=self._saw, cancel=self._cancel
        )
        result.folder, result.struts = str(target.resolve()), outcome.struts
        result.message = outcome.message
        write_scenario(scenario, target)
        if outcome.success:
            report = write_report(read_recording(target), target)
            evaluation = report.evaluation
            result.attenuation = {
                kind: [float(value) for value in evaluation.attenuation[kind]] for kind in KINDS
            }
            if shortfalls := report.result['shortfalls']:
                result.message = f'this run is no result: {" ".join(shortfalls)}'
            result.success = not shortfalls

    def _saw(self, progress: Progress) -> None:
        self.progress = progress
