# SPDX-FileCopyrightText: 2026 The satvib authors
# SPDX-License-Identifier: Apache-2.0
"""One live run of satvib in a process of its own, as the command makes it, with its figures as JSON."""

import json
import os
import sys
import time
from pathlib import Path
from typing import Any

from satvib_experiment.scenario.scenario import load_scenario

from satvib_bringup.live.bench.usage import children_of, usage_of
from satvib_bringup.live.progress import Progress
from satvib_bringup.live.run import run_experiment


def measure(plan: dict[str, Any]) -> dict[str, Any]:
    """Run and measure.

    Args:
        plan: scenario, settings, realtime, composition, folder, arrivals.
    """
    folder = Path(plan['folder'])
    seen: list[tuple[float, int, dict[str, Any]]] = []
    pids: dict[str, int] = {}
    first_sample: list[float] = []

    def look(progress: Progress) -> None:
        if not first_sample:
            first_sample.append(time.time())
        if not pids:
            pids.update(children_of(os.getpid(), folder))
        if progress.sequence < progress.end - 1:
            seen.append((time.perf_counter(), progress.sequence, usage_of(pids)))

    scenario = load_scenario(plan['scenario'], plan['settings'])
    arrivals = Path(plan['arrivals']) if plan['realtime'] else None
    outcome = run_experiment(
        scenario, folder, plan['realtime'], progress=look, composition=plan['composition'],
        arrivals=arrivals,
    )  # fmt: skip
    if pids and plan['composition'] == 'single':  # no process has ended
        seen.append((time.perf_counter(), outcome.samples - 1, usage_of(pids)))
    if not outcome.success or len(seen) < 2:
        return {'failed': outcome.message or 'too short'}
    (_, k0, before), (_, k1, after) = seen[0], seen[-1]
    steps = max(k1 - k0, 1)
    return {
        'samples_per_s': None if plan['realtime'] else outcome.samples / outcome.wall_time,
        'cpu_of': {n: 1e3 * (after[n].cpu - before[n].cpu) / steps for n in after if n in before},
        'memory': max(u.memory for u in after.values()),
        'memory_all': sum(u.memory for u in after.values()),
        'first_sample': first_sample[0],
        'samples': outcome.samples,
    }


def main() -> None:
    """Run what the JSON in the first argument says, and write its result beside the folder."""
    plan = json.loads(sys.argv[1])
    Path(plan['result']).write_text(json.dumps(measure(plan)), encoding='utf-8')


if __name__ == '__main__':
    main()
