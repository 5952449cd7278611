# SPDX-FileCopyrightText: 2026 The satvib authors
# SPDX-License-Identifier: Apache-2.0
"""How many closed-loop trials a core runs per second, over the size of the batch, and how much memory that takes.

./satvib shell, then python benchmarks/campaign_speed.py [scenario] [--batches 1 8 64 512] [--repeat 1]

The trials are those of a campaign: rigs, disturbances and seeds all differ; figures of truth and measurement are
included, and so are drawing, checking and designing (reading files is not). CPU time is what counts: wall time depends
on what else the machine does. Memory is what the process held at most, over what it
held with everything loaded.
"""

import argparse
import resource
import time

from rich.console import Console
from rich.table import Table
from satvib_studies.campaign.batch import run_part
from satvib_studies.campaign.settings import Campaign
from satvib_studies.campaign.trials import plan_trials

PARAMETERS = {
    'rig.payload.mass': {'kind': 'uniform', 'low': 6.3, 'high': 11.7},
    'rig.coil.resistance': {'kind': 'uniform', 'low': 2.4, 'high': 3.0},
    'disturbance.frequency': {'kind': 'uniform', 'low': 6.0, 'high': 18.0},
}


def largest_memory() -> float:
    """The most that this process has held so far, MB."""
    return resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 1e3


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument('scenario', nargs='?', default='paper_3dof')
    parser.add_argument('--batches', type=int, nargs='+', default=[1, 8, 64, 256, 512, 1024])
    parser.add_argument('--repeat', type=int, default=1, help='the fastest counts')
    options = parser.parse_args()
    largest = max(options.batches)
    plan = plan_trials(
        Campaign(name='speed', scenario=options.scenario, trials=largest, parameters=PARAMETERS)
    )
    run_part(plan.part([0, 1]))  # kernels are loaded, caches are warm
    before = largest_memory()
    table = Table(title=f'{options.scenario}, one core')
    for heading in ('batch', 'ms per trial', 'trials per s', 'MB at most'):
        table.add_column(heading, justify='right')
    for size in options.batches:
        part = plan.part(range(largest - size, largest))
        best = float('inf')
        for _ in range(options.repeat):
            started = time.process_time()
            run_part(part)
            best = min(best, (time.process_time() - started) / size)
        table.add_row(
            str(size), f'{1e3 * best:.1f}', f'{1.0 / best:.1f}', f'{largest_memory() - before:.0f}'
        )
    Console(width=90).print(table)


if __name__ == '__main__':
    main()
