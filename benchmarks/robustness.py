# SPDX-FileCopyrightText: 2026 The satvib authors
# SPDX-License-Identifier: Apache-2.0
"""Do the laws stay stable when the rig is not what the model says?

    ./satvib shell
    python benchmarks/robustness.py --trials 2000 --page docs/laws.md

Each trial draws a rig: payload mass and stiffness +-30 %, force constant +-10 %, resistance +-12.5 %, inductance
+-30 %, input delay +-1 ms (not below 0), own noise and bias; the disturbance is 10 Hz. Two cases: `own` identifies the
drawn rig, as the graph does; `nominal` hands every trial the model of the nominal rig, whatever it is in truth.

A trial is *unstable* when a fault is latched, or when the vibration that the loop sees in the last 2 s is above 1.5
times that without control. *Backed off*: the watch, or the law itself, took the voltage back at least once. Attenuation
is true RMS (fine grid) with control over without, of a trial the worst strut; *worse*: above +0.5 dB of that.
"""

import argparse
from pathlib import Path

from satvib_studies.benchmark.robustness import END, LAWS, RIGS, table
from satvib_studies.sweep.tables import fill


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument('--trials', type=int, default=200)
    parser.add_argument('--first', type=int, default=0, help='number of the first trial')
    parser.add_argument('--end', type=float, default=END, help='seconds; CONTROL begins at 6.5')
    parser.add_argument('--rigs', nargs='+', default=list(RIGS), choices=list(RIGS))
    parser.add_argument('--laws', nargs='+', default=list(LAWS))
    parser.add_argument(
        '--cases', nargs='+', default=['own', 'nominal'], choices=['own', 'nominal']
    )
    parser.add_argument('--page', type=Path, help='page with the mark <!-- table robustness -->')
    options = parser.parse_args()
    lines = []
    numbers = range(options.first, options.first + options.trials)
    for line in table(options.rigs, options.laws, options.cases, numbers, options.end):
        print(line, flush=True)
        lines.append(line + '\n')
    if options.page is not None:
        fill(options.page, {'table robustness': ''.join(lines)})


if __name__ == '__main__':
    main()
