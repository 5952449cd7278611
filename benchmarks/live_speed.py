# SPDX-FileCopyrightText: 2026 The satvib authors
# SPDX-License-Identifier: Apache-2.0
"""How fast the live graph goes in lockstep, and what a step costs in each process.

./satvib shell, then python benchmarks/live_speed.py [scenario] [--no-record] [--set key=value ...]

Prints samples per second of wall time, the factor to real time, and per process the CPU time of a step (user and
kernel), from /proc. CPU time is the figure to compare: wall time depends on what else the machine does.
"""

import argparse
import os
import tempfile
import time
from pathlib import Path

from satvib_bringup.live.progress import Progress
from satvib_bringup.live.run import run_experiment
from satvib_experiment.scenario.scenario import load_scenario

TICK = os.sysconf('SC_CLK_TCK')


def processes(folder: Path) -> dict[str, tuple[float, float]]:
    """User and kernel time in s of every process whose command line names the run's folder."""
    found = {'runner': os.times()[:2]}
    for path in Path('/proc').glob('[0-9]*/cmdline'):
        try:
            words = path.read_bytes().decode().split('\0')
            if not any(str(folder) in word for word in words):
                continue
            fields = (path.parent / 'stat').read_text().rpartition(')')[2].split()
        except OSError:
            continue
        namespace = next((w.removeprefix('__ns:=') for w in words if w.startswith('__ns:=')), '')
        name = next((w.removeprefix('__node:=') for w in words if w.startswith('__node:=')), '')
        found[f'{namespace}/{name}'] = (int(fields[11]) / TICK, int(fields[12]) / TICK)
    return found


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument('scenario', nargs='?', default='paper_3dof')
    parser.add_argument('--no-record', action='store_true')
    parser.add_argument('--set', action='append', default=[])
    options = parser.parse_args()
    scenario = load_scenario(options.scenario, options.set)
    seen = []
    with tempfile.TemporaryDirectory() as place:
        folder = Path(place) / 'run'

        def look(progress: Progress) -> None:
            if progress.sequence < progress.end - 1:
                seen.append((time.monotonic(), progress.sequence, processes(folder)))

        started = time.monotonic()
        outcome = run_experiment(scenario, folder, record=not options.no_record, progress=look)
        total = time.monotonic() - started
    print(outcome.message)
    print(f'start and stop: {total - outcome.wall_time:.1f} s')
    (t0, k0, before), (t1, k1, after) = seen[0], seen[-1]
    steps = max(k1 - k0, 1)
    print(f'{steps / (t1 - t0):.0f} samples/s over {steps} samples; CPU per sample in us:')
    whole = 0.0
    for name in sorted(after):
        user, kernel = (
            1e6 * (b - a) / steps for a, b in zip(before[name], after[name], strict=True)
        )
        whole += user + kernel
        print(f'  {name:28s} user {user:6.0f}  kernel {kernel:6.0f}')
    print(f'  {"all":28s} {whole:18.0f}')


if __name__ == '__main__':
    main()
