# SPDX-FileCopyrightText: 2026 The satvib authors
# SPDX-License-Identifier: Apache-2.0
"""A long run of a graph, and what grows in it: memory, descriptors, shared memory, latency; and what is lost or late.

    python soaking.py '{"scenario": ..., ...}'      one run in a process of its own, started by `soak`

Memory grows while histories fill: a writer keeps its last 1000 messages. So what counts is the slope after the first
third of a run: the median of the slopes between all pairs of readings (Theil and Sen), with its 95 % interval.
"""

import json
import subprocess
import sys
import time
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np
from scipy.stats import theilslopes

_HOUR = 3600.0  # s
_MEGABYTE = 2.0**20
_FROM = 1.0 / 3.0  # of the run
_POLL = 0.02  # s, how often the progress is looked at


class Reading(NamedTuple):
    """Of one process at one time.

    Attributes:
        time: s of the steady clock.
        resident: MB, of which what is shared counts in full.
        share: MB, of which what is shared counts in parts (PSS).
        private: MB, without what is shared (USS).
        descriptors: open ones.
        shared: files of Fast DDS in shared memory that it uses: none.
    """

    time: float
    resident: float
    share: float
    private: float
    descriptors: int
    shared: int


class Growth(NamedTuple):
    """What became of one process.

    Attributes:
        first, last: readings: when the first third was over, and near the end.
        resident, share, private: MB/hour with the ends of the 95 % interval.
    """

    first: Reading
    last: Reading
    resident: tuple[float, float, float]
    share: tuple[float, float, float]
    private: tuple[float, float, float]

    @property
    def grown(self) -> float:
        """MB of private memory from the first third to the end."""
        return self.last.private - self.first.private


class Soak(NamedTuple):
    """What one run showed.

    Attributes:
        processes: by name.
        outcome: success, message, samples, wall_time, struts, and gaps by topic.
        speed: samples a second in the first tenth of the run and in the last one.
        latency: ms, in real time: 50th and 99th percentile of the first tenth and of the last one; None: lockstep.
        late: voltages that came after the next sample was due, those that never came, and late samples; None: lockstep.
    """

    processes: dict[str, Growth]
    outcome: dict[str, Any]
    speed: tuple[float, float]
    latency: tuple[float, float, float, float] | None
    late: tuple[int, int, int] | None


def reading_of(pid: int, now: float) -> Reading:
    """Read /proc.

    Raises:
        OSError: the process has ended.
    """
    from processes import shared_memory

    place = Path('/proc', str(pid))
    found = dict.fromkeys(('Rss', 'Pss', 'Private_Clean', 'Private_Dirty'), 0.0)
    for line in (place / 'smaps_rollup').read_text().splitlines()[1:]:
        name, _, rest = line.partition(':')
        if name in found:
            found[name] = float(rest.split()[0]) / 1024.0
    return Reading(
        now, found['Rss'], found['Pss'], found['Private_Clean'] + found['Private_Dirty'],
        len(list((place / 'fd').iterdir())), len(shared_memory(pid)),
    )  # fmt: skip


def growth_of(readings: list[Reading], begin: float, end: float) -> Growth | None:
    """Give the growth of a process after the first third of the samples, which came from `begin` to `end`.

    None: there are fewer than ten readings.
    """
    table = np.array(readings)
    # the plant may end before its last sample is reported
    end -= min(0.03 * (end - begin), 1.0)
    later = table[(table[:, 0] >= begin + _FROM * (end - begin)) & (table[:, 0] <= end)]
    if len(later) < 10:
        return None

    def slope(name: str) -> tuple[float, float, float]:
        column = Reading._fields.index(name)
        # an hour has so many readings that their pairs would fill the memory
        chosen = later[:: max(len(later) // 1000, 1)]
        middle, _, low, high = theilslopes(chosen[:, column], chosen[:, 0] / _HOUR)
        return float(middle), float(low), float(high)

    first, last = (Reading(*row[:4], int(row[4]), int(row[5])) for row in (later[0], later[-1]))
    return Growth(first, last, slope('resident'), slope('share'), slope('private'))


def soak(
    scenario: str,
    settings: list[str],
    folder: Path,
    realtime: bool,
    composition: str = 'separate',
    every: int = 200,
) -> Soak:
    """Run a scenario and watch its processes.

    Args:
        scenario: its name.
        settings: changes to it, as on the command line.
        folder: for the run; it must not exist.
        realtime: samples follow the clock; otherwise lockstep.
        composition: which nodes share a process.
        every: samples between two readings, so that a fast machine gives as many as a slow one.

    Raises:
        RuntimeError: the run failed, with its last words.
    """
    from satvib_bringup.live.bench.usage import children_of

    folder.mkdir(parents=True)
    plan = {
        'scenario': scenario, 'settings': settings, 'realtime': realtime, 'composition': composition,
        'folder': str(folder / 'run'), 'arrivals': str(folder / 'arrivals.npz'),
        'progress': str(folder / 'progress.txt'), 'result': str(folder / 'result.json'),
    }  # fmt: skip
    found: dict[str, list[Reading]] = {}
    with (folder / 'log').open('wb') as log:
        running = subprocess.Popen(
            [sys.executable, __file__, json.dumps(plan)], stdout=log, stderr=subprocess.STDOUT
        )
        try:
            due = 0
            while running.poll() is None:
                if (there := _progress(Path(plan['progress']))) >= due:
                    due = there + every
                    for name, pid in children_of(running.pid, folder / 'run').items():
                        try:
                            reading = reading_of(pid, time.monotonic())
                        except OSError:  # it has ended meanwhile
                            continue
                        found.setdefault(name, []).append(reading)
                # the only way to wait for it and for a time
                try:
                    running.wait(_POLL)
                except subprocess.TimeoutExpired:
                    continue
        finally:
            running.kill()
    if not Path(plan['result']).exists():
        raise RuntimeError((folder / 'log').read_text(errors='replace')[-1000:])
    outcome = json.loads(Path(plan['result']).read_text(encoding='utf-8'))
    times = np.loadtxt(plan['progress'], ndmin=2)[:, 0]
    grown = {name: growth_of(readings, times[0], times[-1]) for name, readings in found.items()}
    latency, late = _latency(Path(plan['arrivals']), outcome) if realtime else (None, None)
    return Soak(
        {name: growth for name, growth in grown.items() if growth is not None},
        outcome, _speed(Path(plan['progress'])), latency, late,
    )  # fmt: skip


def _progress(path: Path) -> int:
    """The newest sample, -1: none yet."""
    try:
        with path.open('rb') as source:
            source.seek(max(source.seek(0, 2) - 100, 0))
            # the last line may not be whole yet
            return int(source.read().split(b'\n')[-2].split()[1])
    except (OSError, IndexError):
        return -1


def _speed(progress: Path) -> tuple[float, float]:
    """Samples a second in the first and in the last tenth of the samples."""
    times, samples = np.loadtxt(progress, ndmin=2).T
    edges = np.interp(np.array([0.05, 0.15, 0.85, 0.95]) * samples[-1], samples, times)
    tenth = 0.1 * samples[-1]
    first, last = edges[1] - edges[0], edges[3] - edges[2]
    return float(tenth / max(first, 1e-9)), float(tenth / max(last, 1e-9))


def _latency(
    arrivals: Path, outcome: dict[str, Any]
) -> tuple[tuple[float, float, float, float], tuple[int, int, int]]:
    noted = np.load(arrivals)
    voltages, samples = noted['voltages'], outcome['samples']
    _, firsts = np.unique(voltages[:, :2], axis=0, return_index=True)
    sample, delay = voltages[firsts, 1], 1e3 * voltages[firsts, 2]
    # what is cold does not count: the first second
    first = delay[(sample > outcome['rate']) & (sample < 0.1 * samples)]
    last = delay[sample >= 0.9 * samples]
    percentiles = [float(np.percentile(part, q)) for part in (first, last) for q in (50.0, 99.0)]
    missed = outcome['struts'] * samples - len(delay)
    late = int(np.sum(delay > 1e3 / outcome['rate']))
    return (*percentiles,), (late, missed, int(noted['late_samples']))  # type: ignore[return-value]


def run(plan: dict[str, Any]) -> None:
    """Run what the plan says, and write its outcome."""
    from satvib_bringup.live.run import run_experiment
    from satvib_experiment.scenario.scenario import load_scenario

    scenario = load_scenario(plan['scenario'], plan['settings'])
    arrivals = Path(plan['arrivals']) if plan['realtime'] else None
    with Path(plan['progress']).open('w', buffering=1) as sink:
        outcome = run_experiment(
            scenario, Path(plan['folder']), plan['realtime'], composition=plan['composition'],
            progress=lambda seen: sink.write(f'{time.monotonic()} {seen.sequence}\n'),
            arrivals=arrivals,
        )  # fmt: skip
    gaps = {topic: row.get('gaps') or 0 for topic, row in outcome.recording.items()}
    result = {
        'success': outcome.success, 'message': outcome.message, 'samples': outcome.samples,
        'wall_time': outcome.wall_time, 'struts': len(outcome.struts),
        'rate': scenario.load_rig().acquisition.sample_rate,
        # a topic of the models has gaps by design
        'lost': sum(n for t, n in gaps.items() if t.endswith(('/acceleration', '/voltage'))),
        'bag': sum(path.stat().st_size for path in (outcome.bag or Path()).glob('*.mcap')),
    }  # fmt: skip
    Path(plan['result']).write_text(json.dumps(result), encoding='utf-8')


if __name__ == '__main__':
    run(json.loads(sys.argv[1]))
