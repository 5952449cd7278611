# SPDX-FileCopyrightText: 2026 The satvib authors
# SPDX-License-Identifier: Apache-2.0
"""Runs a scenario as a live graph: start everything, publish the schedule, watch, stop everything, check the recording.

    outcome = run_experiment(load_scenario('paper_3dof'), Path('runs/today'))

The plant ends the run when the plan is over. Whatever else ends before it ends the run at once, by name; the bag is
closed, or put together from what a killed recorder has left. In the composition `single` there is one process, this one
(`single`).
"""

import contextlib
import os
import signal
import threading
import time
from collections.abc import Callable, Iterator
from dataclasses import dataclass, field
from pathlib import Path

from satvib_common.errors import SatvibError
from satvib_common.transport.reach import set_transport
from satvib_experiment.recording.run_folder import make_run_folder
from satvib_experiment.scenario.scenario import Scenario

from satvib_bringup.live.discovery import Discovery
from satvib_bringup.live.graph import Graph, graph_of
from satvib_bringup.live.observer import Observer
from satvib_bringup.live.process import Process, Stage
from satvib_bringup.live.progress import Outcome, Progress
from satvib_bringup.live.security.enclaves import enclave_arguments
from satvib_bringup.live.single import EndedError, SingleRun
from satvib_bringup.live.supervisor import Supervisor
from satvib_bringup.live.workspace import executable, graph_environment
from satvib_bringup.recorder.check import complaint, read_report
from satvib_bringup.recorder.salvage import is_finished, salvage

# s
_LOOK_AROUND = 0.4  # to find a graph that is running on this domain
_START = 60.0  # for all processes to be there, on a busy machine and with cold caches
_POLL = 0.02
_REPORT = 0.15
_PATIENCE = {Stage.SOURCE: 2.0, Stage.CONTROLLER: 5.0, Stage.IDENTIFIER: 15.0, Stage.RECORDER: 30.0}
_IMPATIENCE = 1.5  # more than the second for which a node waits for a reader that has ended


def run_experiment(
    scenario: Scenario,
    folder: Path,
    realtime: bool = False,
    record: bool = True,
    progress: Callable[[Progress], None] | None = None,
    cancel: threading.Event | None = None,
    composition: str = '',
    arrivals: Path | None = None,
) -> Outcome:
    """Run a scenario as a live graph.

    Args:
        scenario: checked.
        folder: for parameters, logs and bag; it must not exist.
        realtime: samples follow the clock; otherwise lockstep, as fast as it goes.
        record: write a bag.
        progress: called a few times a second.
        cancel: set it to end the run early.
        composition: separate, strut or single; empty: as the scenario says.
        arrivals: in real time, file for the arrivals of the voltages; None: none.

    Returns:
        How it ended; `success` is false after an early end of a process, an interruption, or lost messages.

    Raises:
        SatvibError: nothing was started: the folder, the domain, the workspace, the parameters.
    """
    bag = folder / 'bag' if record else None
    graph = graph_of(scenario, realtime, bag, composition, arrivals)
    commands = {p.full_name: executable(p.package, p.executable) for p in graph.processes}
    set_transport()
    if not graph.processes:
        with SingleRun(graph) as single, interruptible(cancel) as interrupted:
            _refuse_foreign_nodes(single.discovery)
            make_run_folder(folder)
            return _in_this_process(single, folder, bag, interrupted, progress)
    with Observer(graph) as observer, interruptible(cancel) as interrupted:
        _refuse_foreign_nodes(observer.discovery)
        make_run_folder(folder)
        run = _Run(graph, folder, bag, interrupted)
        with Supervisor(folder / 'logs', graph_environment(), take_signals=True) as supervisor:
            return run.go(supervisor, observer, commands, progress)


def _in_this_process(
    single: SingleRun,
    folder: Path,
    bag: Path | None,
    interrupted: threading.Event,
    progress: Callable[[Progress], None] | None,
) -> Outcome:
    run = _Run(single.graph, folder, bag, interrupted)
    run.write_parameters()
    began = time.monotonic()
    try:
        began = single.start()
        single.run(interrupted, progress)
    except EndedError as ended:
        run.samples, run.wall_time = single.samples, time.monotonic() - began
        return run.ended_early(ended)
    run.wall_time = time.monotonic() - began
    return run.complete()


def _refuse_foreign_nodes(discovery: Discovery) -> None:
    deadline = time.monotonic() + _LOOK_AROUND
    while time.monotonic() < deadline:
        if others := list(discovery.nodes()):
            raise SatvibError(_foreign_message(others))
        time.sleep(0.05)


def _foreign_message(others: list[str]) -> str:
    domain = os.environ.get('ROS_DOMAIN_ID', '0')
    named = ', '.join(others[:3]) + (', ...' if len(others) > 3 else '')
    return (
        f'domain {domain}: a satvib graph is already running here ({named}); stop it, or set '
        'another ROS_DOMAIN_ID'
    )


@contextlib.contextmanager
def interruptible(cancel: threading.Event | None) -> Iterator[threading.Event]:
    """Turn SIGINT and SIGTERM into an event, in the main thread; elsewhere `cancel` alone counts."""
    event = cancel or threading.Event()
    before = {}
    if threading.current_thread() is threading.main_thread():
        for number in (signal.SIGINT, signal.SIGTERM):
            before[number] = signal.signal(number, lambda *_: event.set())
    try:
        yield event
    finally:
        for number, handler in before.items():
            signal.signal(number, handler)


@dataclass
class _Run:
    """One run, from the first process to the last."""

    graph: Graph
    folder: Path
    bag: Path | None
    interrupted: threading.Event
    samples: int = 0
    began: float | None = None
    wall_time: float = 0.0
    killed: set[str] = field(default_factory=set)

    def go(
        self,
        supervisor: Supervisor,
        observer: Observer,
        commands: dict[str, Path],
        progress: Callable[[Progress], None] | None,
    ) -> Outcome:
        try:
            for process in self.graph.processes:
                self._start(supervisor, process, commands[process.full_name])
            self._gather(supervisor, observer)
            observer.publish_schedule()
            self.began = time.monotonic()
            self._watch(supervisor, observer, progress)
            self.wall_time = time.monotonic() - self.began
            self._stop_in_order(supervisor)
        except EndedError as ended:
            return self._failed(supervisor, ended)
        return self.complete()

    def complete(self) -> Outcome:
        """The run came to its end; check what was recorded."""
        self.samples = self.graph.plan.end
        wrong = ''
        if self.bag is not None:
            graph = self.graph
            report = read_report(self.folder)
            wrong = complaint(report, graph.struts, graph.expected, graph.silenced())
        return self._outcome(wrong, 1 if wrong else 0)

    def write_parameters(self) -> None:
        """Write down with which parameters the nodes run that have no process of their own."""
        for node in self.graph.nodes:
            process = Process(node.package, node.executable, node.namespace, node.name, (node,))
            self._parameter_file(process)

    def _parameter_file(self, process: Process) -> Path:
        path = self.folder / 'parameters' / f'{process.full_name.replace("/", ".")}.yaml'
        path.parent.mkdir(exist_ok=True)
        path.write_text(process.parameter_file(), encoding='utf-8')
        return path

    def _start(self, supervisor: Supervisor, process: Process, path: Path) -> None:
        parameters = self._parameter_file(process)
        given = process.arguments(parameters) + enclave_arguments(process.full_name)
        supervisor.start(process.full_name, [str(path), *given])

    def _gather(self, supervisor: Supervisor, observer: Observer) -> None:
        """Wait until every node is there and every topic has its writer and its readers."""
        deadline = time.monotonic() + _START
        while missing := observer.missing():
            self._has_ended(supervisor)
            if foreign_nodes := observer.discovery.foreign_nodes():
                raise EndedError(_foreign_message(foreign_nodes), 2)
            if time.monotonic() > deadline:
                named = ', '.join(missing[:3]) + (', ...' if len(missing) > 3 else '')
                raise EndedError(f'the graph is not complete after {_START:g} s: {named}', 1)
            time.sleep(_POLL)

    def _watch(
        self,
        supervisor: Supervisor,
        observer: Observer,
        progress: Callable[[Progress], None] | None,
    ) -> None:
        """Until the plant ends."""
        report_at = 0.0
        while not self._has_ended(supervisor):
            now = time.monotonic()
            if now >= report_at:
                report_at = now + _REPORT
                seen = observer.look()
                if seen is not None:
                    self.samples = seen.sequence + 1
                    if progress is not None:
                        progress(seen)
            self._kill_as_planned(supervisor, observer)
            time.sleep(_POLL)

    def _kill_as_planned(self, supervisor: Supervisor, observer: Observer) -> None:
        """Kill the processes that the scenario kills by now."""
        left = [(k, name) for k, name in self.graph.kills if name not in self.killed]
        if not left:
            return
        seen = observer.look()
        for k, name in left:
            if seen is not None and seen.sequence >= k:
                self.killed.add(name)
                supervisor.kill(name)

    def _has_ended(self, supervisor: Supervisor) -> bool:
        """Whether the plant has ended as it should.

        Raises:
            EndedError: anything else ended, or the run was interrupted.
        """
        if self.interrupted.is_set():
            raise EndedError('interrupted', 1)
        ended = supervisor.ended()
        source = {p.full_name for p in self.graph.processes if p.stage == Stage.SOURCE}
        for exit_ in ended:
            if exit_.name in self.killed:
                continue
            if exit_.name not in source or exit_.code != 0:
                raise EndedError(str(exit_), 2 if exit_.code == 2 else 1)
        return any(exit_.name in source for exit_ in ended)

    def _stop_in_order(self, supervisor: Supervisor) -> None:
        for stage in Stage:
            names = [p.full_name for p in self.graph.processes if p.stage == stage]
            for exit_ in supervisor.stop(names, _PATIENCE[stage]):
                if exit_.code != 0:
                    raise EndedError(f'{exit_} (after the request to stop)', 1)

    def _failed(self, supervisor: Supervisor, ended: EndedError) -> Outcome:
        """Stop what is left, the recorder last, and save the recording."""
        if self.began is not None:
            self.wall_time = time.monotonic() - self.began
        recorders = [p.full_name for p in self.graph.processes if p.stage == Stage.RECORDER]
        others = [p.full_name for p in self.graph.processes if p.stage != Stage.RECORDER]
        supervisor.stop(others, _IMPATIENCE)
        supervisor.stop(recorders, _PATIENCE[Stage.RECORDER])
        return self.ended_early(ended)

    def ended_early(self, ended: EndedError) -> Outcome:
        """Say why, and save the recording."""
        message = f'{ended} at sample {self.samples}' if self.samples else str(ended)
        if self.bag is not None and self.bag.exists() and not is_finished(self.bag):
            try:
                saved = salvage(self.bag, self.graph.custom)
            except OSError as error:
                message += (
                    f'; the unfinished recording is in {self.bag}, and cannot be finished there: '
                    f'{error.strerror}'
                )
            else:
                message += f'; {saved} messages of the unfinished recording are saved in {self.bag}'
        return self._outcome(message, ended.code)

    def _outcome(self, wrong: str, code: int) -> Outcome:
        plan, period = self.graph.plan, self.graph.sample_period
        speed = self.samples * period / self.wall_time if self.wall_time else 0.0
        message = wrong or (
            f'{plan.end} samples of {len(self.graph.struts)} struts in {self.wall_time:.1f} s, '
            f'{speed:.1f} times real time'
        )
        return Outcome(
            not wrong, code, message, self.folder, self.bag, self.graph.struts, self.samples,
            self.wall_time, read_report(self.folder),
        )  # fmt: skip
