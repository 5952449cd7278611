# SPDX-FileCopyrightText: 2026 The satvib authors
# SPDX-License-Identifier: Apache-2.0
"""What grows in a long run: memory, descriptors and shared memory of every process, and late samples.

    ./satvib shell
    python benchmarks/soak.py --minutes 60               # real time, 200 Hz
    python benchmarks/soak.py --minutes 60 --lockstep    # an hour of the clock, as fast as it goes

The slope is the median of the slopes between all pairs of readings (Theil and Sen) after the first third, in which
caches and histories fill.
"""

import argparse
import json
import os
import subprocess
import sys
import tempfile
import time
from collections import defaultdict
from pathlib import Path

import numpy as np
import psutil
from satvib_bringup.live.bench.usage import children_of
from scipy.stats import theilslopes

_EVERY = 1.0  # s


def watch(command: list[str], folder: Path) -> dict[str, list[tuple[float, float, int]]]:
    """Run a command; gives for each process (s, MB, descriptors), once a second."""
    found = defaultdict(list)
    began = time.monotonic()
    running = subprocess.Popen(
        command, stdout=subprocess.DEVNULL, stderr=subprocess.PIPE, text=True
    )
    while running.poll() is None:
        for name, pid in children_of(running.pid, folder).items():
            try:
                process = psutil.Process(pid)
                memory = process.memory_full_info().uss / 2**20
                found[name].append((time.monotonic() - began, memory, process.num_fds()))
            except psutil.Error:
                continue
        time.sleep(_EVERY)
    assert running.stderr is not None
    if running.returncode not in (0, 3):
        sys.exit(f'{" ".join(command)}: exit code {running.returncode}: {running.stderr.read()}')
    return found


def table(found: dict[str, list[tuple[float, float, int]]]) -> list[str]:
    """Rows: process, MB at the end, MB an hour with its 95 % interval, descriptors at the third and at the end."""
    lines = ['| process | MB | MB/hour | 95 % | descriptors |', '|---|---:|---:|---:|---:|']
    for name, readings in sorted(found.items()):
        times, memory, descriptors = np.array(readings).T
        # the last readings are of the end, when the bag gets its index
        late = (times > times[0] + (times[-1] - times[0]) / 3) & (times < times[-1] - 3.0)
        if late.sum() < 10:
            continue
        slope, _, low, high = theilslopes(memory[late], times[late] / 3600.0)
        lines.append(
            f'| {name} | {memory[late][-1]:.1f} | {slope:+.2f} | {low:+.2f} to {high:+.2f} | '
            f'{descriptors[late][0]:.0f}, {descriptors[late][-1]:.0f} |'
        )
    return lines


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument('--minutes', type=float, default=3.0, help='of the run')
    parser.add_argument('--lockstep', action='store_true')
    parser.add_argument('--scenario', default='soft_3dof')
    parser.add_argument('--set', nargs='+', default=[], dest='more')
    parser.add_argument('--composition', default='separate')
    given = parser.parse_args()
    os.environ.setdefault('ROS_DOMAIN_ID', '94')
    before = len(list(Path('/dev/shm').glob('fastrtps*')))
    with tempfile.TemporaryDirectory(prefix='satvib-soak-') as place:
        folder = Path(place, 'run')
        command = [
            sys.executable, '-m', 'satvib_bringup.cli.main', 'run', given.scenario,
            '--folder', str(folder), '--composition', given.composition,
        ]  # fmt: skip
        for change in (f'duration={60.0 * given.minutes}', *given.more):
            command += ['--set', change]
        if not given.lockstep:
            command.append('--realtime')
        began = time.monotonic()
        found = watch(command, folder)
        print(f'{given.minutes:g} minutes in {(time.monotonic() - began) / 60.0:.1f} minutes')
        print('\n'.join(table(found)))
        result = json.loads((folder / 'result.json').read_text())
        size = sum(path.stat().st_size for path in (folder / 'bag').iterdir())
        print(f'bag {size / 1e6:.1f} MB; shared memory files {before} before')
        print(json.dumps({k: result.get(k) for k in ('late', 'timing', 'shortfalls')}))
    print(f'{len(list(Path("/dev/shm").glob("fastrtps*")))} files in shared memory after')


if __name__ == '__main__':
    main()
