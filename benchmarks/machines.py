# SPDX-FileCopyrightText: 2026 The satvib authors
# SPDX-License-Identifier: Apache-2.0
"""A graph on several machines: how its nodes find each other, how late voltages are, what a strut does without network.

    ./satvib shell -c 'python benchmarks/machines.py --page docs/network.md'
    ./satvib shell -c 'python benchmarks/machines.py --only cable --timeout 0.6'

The plant and the recorder are on one machine, controller and identifier of each strut on a machine of their own. The
machines are network namespaces of this one, joined by veth and a bridge (tests/network.py): real sockets and real DDS,
and no delay of cables. Rig paper_3dof, 100 samples a second, velocity feedback.
"""

import argparse
import json
import os
import subprocess
import sys
import tempfile
import time
from collections.abc import Callable
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np
from satvib_bringup.live.graph import Graph, graph_of
from satvib_bringup.live.process import Stage
from satvib_bringup.live.workspace import executable
from satvib_common.struts.applied import WITHHELD, Applied
from satvib_experiment.recording.bag_reader import read_recording
from satvib_experiment.scenario.scenario import Scenario, load_scenario

ROOT = Path(__file__).resolve().parent.parent
sys.path.insert(0, str(ROOT / 'tests'))

from network import Machine, Network, enter  # noqa: E402 - it lives with the tests

STRUTS = 3
AWAY = 1  # index of the strut whose machine is troubled
_SCENARIO = """
name: machines
rig: paper_3dof
seed: 1
duration: {duration}
command_timeout: {timeout}
phases:
  - {{phase: CALIBRATE, start: 0.0}}
  - {{phase: CONTROL, start: 1.0}}
disturbance: {{kind: sine, frequency: 10.0, amplitude: 1.0, start: 1.0}}
controller: {{law: velocity_feedback}}
analysis: {{uncontrolled: [0.2, 0.9], controlled: [{settled}, {duration}]}}
"""
_SUBNET = {'ROS_AUTOMATIC_DISCOVERY_RANGE': 'SUBNET'}
_PORT = 11811
BEGIN, END = '<!-- machines: written by benchmarks/machines.py -->', '<!-- end of machines -->'

# waits for a number of seconds of the run
Wait = Callable[[float], None]
Trouble = Callable[[Machine, Wait], list[float]]


class Case(NamedTuple):
    """One run.

    Attributes:
        name: in the tables.
        variables: of the environment of every node; `PEERS` and `SERVER` stand for addresses.
        duration: s.
        trouble: what happens to one machine; gives the instants (s of the clock) of its beginning and end.
        together: all processes are on one machine.
    """

    name: str
    variables: dict[str, str]
    duration: float = 12.0
    trouble: Trouble | None = None
    together: bool = False


def pull_for(seconds: float) -> Trouble:
    """The cable of a machine is pulled for a while."""

    def trouble(machine: Machine, wait: Wait) -> list[float]:
        wait(4.0)
        machine.cable(False)
        begin = time.time()
        wait(4.0 + seconds)
        machine.cable(True)
        return [begin, time.time()]

    return trouble


def lose(share: float, seconds: float) -> Trouble:
    """A share of the frames of a machine is lost for a while."""

    def trouble(machine: Machine, wait: Wait) -> list[float]:
        wait(2.0)
        machine.lose(share)
        begin = time.time()
        wait(2.0 + seconds)
        machine.lose_nothing()
        return [begin, time.time()]

    return trouble


CASES = (
    Case('one machine, closed', {}, together=True),
    Case('several, multicast', _SUBNET),
    Case('several, static peers', {'ROS_AUTOMATIC_DISCOVERY_RANGE': 'LOCALHOST', 'ROS_STATIC_PEERS': 'PEERS'}),
    Case('several, discovery server', _SUBNET | {'ROS_DISCOVERY_SERVER': 'SERVER'}),
    Case('cable of strut 2 pulled for 3 s', _SUBNET, 14.0, pull_for(3.0)),
    Case('cable of strut 2 pulled for 25 s', _SUBNET, 40.0, pull_for(25.0)),
    Case('1 % of the frames of strut 2 lost', _SUBNET, 34.0, lose(0.01, 30.0)),
)  # fmt: skip


class Figures(NamedTuple):
    """What a run gave; times in s and ms as named, NaN where there is none.

    Attributes:
        found: s, from the start of the last process to sample 0.
        median, worst_of_100, largest: ms, of a voltage after its sample.
        late, missing: share of all samples of all struts: answered after the period, or not at all.
        zero: s, from the trouble to 0 V at the coil of the troubled strut.
        back: s, from the end of the trouble until its voltage is applied in full again.
        at_zero: share of its samples at 0 V during the trouble.
        others: samples of the other struts at 0 V.
        peak: V, largest of all.
    """

    found: float
    median: float
    worst_of_100: float
    largest: float
    late: float
    missing: float
    zero: float
    back: float
    at_zero: float
    others: int
    peak: float


class Run:
    """The processes of one case."""

    def __init__(self, case: Case, folder: Path, timeout: float, machines: list[Machine]) -> None:
        self.case, self.folder, self.machines = case, folder, machines
        scenario_file = folder / 'scenario.yaml'
        text = _SCENARIO.format(
            duration=case.duration, timeout=timeout, settled=case.duration - 2.0
        )
        scenario_file.write_text(text)
        self.scenario: Scenario = load_scenario(str(scenario_file))
        self.arrivals = folder / 'arrivals.npz'
        self.graph: Graph = graph_of(
            self.scenario, True, folder / 'bag', composition='strut', arrivals=self.arrivals
        )
        self.period = self.graph.sample_period
        peers = ';'.join(machine.address for machine in machines)
        place = {'PEERS': peers, 'SERVER': f'{machines[0].address}:{_PORT}'}
        chosen = {name: place.get(value, value) for name, value in case.variables.items()}
        names = (
            'ROS_AUTOMATIC_DISCOVERY_RANGE',
            'ROS_STATIC_PEERS',
            'FASTRTPS_DEFAULT_PROFILES_FILE',
        )
        self.environment = {k: v for k, v in os.environ.items() if k not in names}
        self.environment |= {'ROS_LOG_DIR': str(folder), 'OPENBLAS_NUM_THREADS': '1'} | chosen
        self.processes: dict[str, subprocess.Popen[bytes]] = {}

    def go(self) -> list[float]:
        """Run it; gives the instants of the trouble."""
        try:
            return self._go()
        finally:
            for process in self.processes.values():
                process.kill()
                process.wait()

    def _go(self) -> list[float]:
        plant = self.machines[0]
        if 'ROS_DISCOVERY_SERVER' in self.case.variables:
            server = ['fast-discovery-server', '-i', '0', '-l', plant.address, '-p', str(_PORT)]
            self._start('server', plant, server)
        for process in self.graph.processes:
            parameters = self.folder / f'{process.full_name.replace("/", ".")}.yaml'
            parameters.write_text(process.parameter_file())
            path = str(executable(process.package, process.executable))
            machine = plant if self.case.together else self._machine_of(process.namespace)
            self._start(process.full_name, machine, [path, *process.arguments(parameters)])
        watcher = self._start(
            'watcher', plant, [sys.executable, __file__, '--inside'], subprocess.PIPE
        )
        given = {
            'scenario': str(self.folder / 'scenario.yaml'), 'realtime': 'true', 'composition': 'strut',
            'recorded': 'true',
        }  # fmt: skip
        words = [x for name, value in given.items() for x in ('-p', f'{name}:={value}')]
        path = str(executable('satvib_bringup', 'schedule'))
        # a client of a discovery server knows its own topics only; this node wants to see all
        self._start('schedule', plant, [path, '--ros-args', *words], ROS_SUPER_CLIENT='TRUE')
        self.started = time.time()
        assert watcher.stdout is not None
        self._seen = iter(watcher.stdout)
        moments = (
            self.case.trouble(self.machines[1 + AWAY], self._wait) if self.case.trouble else []
        )
        source = next(p.full_name for p in self.graph.processes if p.stage == Stage.SOURCE)
        self.processes[source].wait(self.case.duration + 120.0)
        for process in self.processes.values():
            process.terminate()
        for process in self.processes.values():
            process.wait(60.0)
        return moments

    def _machine_of(self, namespace: str) -> Machine:
        names = [f'/{strut}' for strut in self.graph.struts]
        return self.machines[1 + names.index(namespace) if namespace in names else 0]

    def _start(
        self, name: str, machine: Machine, words: list[str], out: int | None = None, **more: str
    ) -> 'subprocess.Popen[bytes]':
        with (self.folder / f'{name.replace("/", ".")}.log').open('wb') as log:
            made = subprocess.Popen(
                machine.on(*words), stdout=log if out is None else out, stderr=log, stdin=subprocess.DEVNULL,
                env=self.environment | more, cwd=self.folder, start_new_session=True,
            )  # fmt: skip
        self.processes[name] = made
        return made

    def _wait(self, seconds: float) -> None:
        """Until so many seconds of the run are over."""
        for line in self._seen:
            if int(line) * self.period >= seconds:
                return
        raise RuntimeError(f'{self.case.name}: the run ended early; see the logs in {self.folder}')

    def figures(self, moments: list[float]) -> Figures:
        """What the bag and the arrivals say."""
        recording = read_recording(self.folder / 'bag')
        # a sample says what the coil got before it
        state = recording.get('acceleration', 'applied_state')[1:]
        applied = recording.get('acceleration', 'applied')[1:]
        when = recording.stamp[:-1] * 1e-9
        control = recording.time[:-1] >= 1.5
        with np.load(self.arrivals) as saved:
            strut, sequence, after = saved['voltages'].T
        usual = sequence * self.period >= 1.5
        count = STRUTS * int(control.sum())
        first = after[usual][np.unique(strut[usual] * 1e9 + sequence[usual], return_index=True)[1]]
        withheld = state >= WITHHELD
        zero = back = at_zero = np.nan
        if moments:
            begin, end = moments
            mine, during = withheld[:, AWAY], (when >= begin) & (when < end)
            at_zero = float(mine[during].mean())
            if mine[during].any():
                zero = float(when[during & mine][0] - begin)
            applied_again = (when >= end) & (state[:, AWAY] == Applied.APPLIED)
            if applied_again.any():
                back = float(when[applied_again][0] - end)
        others = np.delete(withheld, AWAY, axis=1) if moments else withheld
        return Figures(
            float(when[0] - self.started), *(1e3 * np.percentile(first, [50, 99, 100])),
            float((first > self.period).sum() / count), 1.0 - min(len(first) / count, 1.0),
            zero, back, at_zero, int(others[control].sum()), float(np.nanmax(np.abs(applied))),
        )  # fmt: skip


def measure(case: Case, timeout: float, keep: Path | None = None) -> Figures:
    """Run one case on machines of its own."""
    with tempfile.TemporaryDirectory(prefix='satvib-machines-') as name:
        folder = keep or Path(name)
        with Network('plant', *(f'strut-{i + 1}' for i in range(STRUTS))) as machines:
            run = Run(case, folder, timeout, machines)
            return run.figures(run.go())


def tables(found: list[tuple[Case, Figures]], timeout: float) -> str:
    """The figures as Markdown."""
    lines = [
        '| nodes | found after | voltage after its sample: median | 99 % | largest | late | missing | largest V |',
        '|---|---:|---:|---:|---:|---:|---:|---:|',
    ]
    for case, f in found:
        if case.trouble is None:
            lines.append(
                f'| {case.name} | {f.found:.1f} s | {f.median:.1f} ms | {f.worst_of_100:.1f} ms | {f.largest:.1f} ms | '
                f'{100 * f.late:.2f} % | {100 * f.missing:.2f} % | {f.peak:.1f} |'
            )
    lines += [
        '',
        f'`command_timeout` {timeout:g} s:',
        '',
        '| what happens | strut 2 at 0 V after | of its samples | applied again after | others at 0 V | largest V |',
        '|---|---:|---:|---:|---:|---:|',
    ]
    for case, f in found:
        if case.trouble is not None:
            zero, back = (
                f'{1e3 * v:.0f} ms' if np.isfinite(v) else 'never' for v in (f.zero, f.back)
            )
            lines.append(
                f'| {case.name} | {zero} | {100 * f.at_zero:.1f} % | {back} | {f.others} samples | {f.peak:.1f} |'
            )
    return '\n'.join(lines)


def watch_samples() -> None:
    """On the machine of the plant: print the number of every fifth sample."""
    import rclpy
    from satvib_common.ros.main import init_ros
    from satvib_common.ros.qos import wanted

    from satvib_msgs.msg import StrutAcceleration

    init_ros(args=[])
    node = rclpy.create_node('watcher')

    def take(message: Any) -> None:
        if message.sequence % 5 == 0:
            print(message.sequence, flush=True)

    node.create_subscription(StrutAcceleration, '/strut_1/acceleration', take, wanted(whole=True))
    rclpy.spin(node)


def main() -> int:
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument('--only', default='', help='a part of the name of a case')
    parser.add_argument('--timeout', type=float, default=0.05, help='command_timeout, s')
    parser.add_argument('--seconds', type=float, help='length of a run in which nothing happens')
    parser.add_argument('--page', type=Path, help='page with the mark <!-- machines: ... -->')
    parser.add_argument('--keep', type=Path, help='folder for logs and bag of a single case')
    parser.add_argument('--json', action='store_true', help='print figures as JSON, by case')
    parser.add_argument('--inside', action='store_true', help=argparse.SUPPRESS)
    given = parser.parse_args()
    if given.inside:
        watch_samples()
        return 0
    if not any(given.only in case.name for case in CASES):
        parser.error(f'--only: {given.only!r} is in none of {"; ".join(c.name for c in CASES)}')
    enter()
    found = []
    for case in CASES:
        if given.only in case.name:
            if given.seconds and case.trouble is None:
                case = case._replace(duration=given.seconds)
            found.append((case, measure(case, given.timeout, given.keep)))
            if not given.json:
                print(f'{case.name}: {found[-1][1]}', flush=True)
    text = tables(found, given.timeout)
    print(json.dumps({c.name: f._asdict() for c, f in found}) if given.json else text)
    if given.page:
        page = given.page.read_text(encoding='utf-8')
        before, after = page.split(BEGIN)[0], page.split(END)[1]
        given.page.write_text(f'{before}{BEGIN}\n\n{text}\n\n{END}{after}', encoding='utf-8')
    return 0


if __name__ == '__main__':
    sys.exit(main())
