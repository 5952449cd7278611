# SPDX-FileCopyrightText: 2026 The satvib authors
# SPDX-License-Identifier: Apache-2.0
"""Does any strut stay louder than its own open loop when the rig changes under control?

./satvib shell
python benchmarks/changes.py --trials 2000
python benchmarks/changes.py --trials 2000 --unchanged    # false stops: only the disturbance changes
"""

import argparse

import numpy as np
from satvib_studies.changes import KINDS, count_stops, run_changes
from satvib_studies.changes.runs import RIGS

LAWS = (
    'velocity_feedback', 'model_reference', 'narrowband', 'feedforward',
    'velocity_feedback+narrowband', 'velocity_feedback+feedforward', 'narrowband+feedforward',
)  # fmt: skip
BATCH = 100
PROMISED = 5.0  # s


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument('--trials', type=int, default=200)
    parser.add_argument('--first', type=int, default=1, help='number of the first trial')
    parser.add_argument('--rigs', nargs='+', default=list(RIGS), choices=list(RIGS))
    parser.add_argument('--laws', nargs='+', default=list(LAWS))
    parser.add_argument('--kinds', nargs='+', default=list(KINDS), choices=list(KINDS))
    parser.add_argument('--worst', type=int, default=3, help='trials to name for each rig and law')
    parser.add_argument('--unchanged', action='store_true', help='count false stops')
    parser.add_argument(
        '--set', nargs='+', default=[], dest='more', help='settings, such as supervisor=true'
    )
    options = parser.parse_args()
    if options.unchanged:
        count(options)
        return
    print(
        '| rig | law | trials | loud for over 5 s | longest [s] | loudest [dB] | as a fresh start | fault |'
    )
    print('|---|---|---:|---:|---:|---:|---:|---:|')
    for rig in options.rigs:
        for law in options.laws:
            show(rig, law, options)


def count(options: argparse.Namespace) -> None:
    numbers = range(options.first, options.first + options.trials)
    print('| rig | law | trials | stopped for good | which |')
    print('|---|---|---:|---:|---|')
    for rig in options.rigs:
        for law in options.laws:
            stopped = np.concatenate(
                [
                    count_stops(rig, law, numbers[at : at + BATCH], options.more).any(axis=-1)
                    for at in range(0, len(numbers), BATCH)
                ]
            )
            which = ', '.join(str(numbers[i]) for i in np.flatnonzero(stopped))
            print(f'| {rig} | {law} | {len(stopped)} | {stopped.sum()} | {which} |', flush=True)


def show(rig: str, law: str, options: argparse.Namespace) -> None:
    numbers = range(options.first, options.first + options.trials)
    parts = [
        run_changes(rig, law, numbers[at : at + BATCH], tuple(options.kinds), options.more)
        for at in range(0, len(numbers), BATCH)
    ]
    time = np.concatenate([part.loud_time for part in parts])
    loudest = np.concatenate([part.loudest for part in parts])
    as_fresh = np.concatenate([np.all(part.end < part.fresh + 3.0, axis=-1) for part in parts])
    fault = np.concatenate([np.any(part.fault, axis=-1) for part in parts])
    print(
        f'| {rig} | {law} | {len(time)} | {np.sum(time > PROMISED)} | {time.max():.1f} | '
        f'{loudest.max():.1f} | {100.0 * as_fresh.mean():.0f} % | {fault.sum()} |',
        flush=True,
    )
    changes = [change for part in parts for change in part.changes]
    for i in np.argsort(-time)[: options.worst]:
        if time[i] > 0.0:
            print(
                f'    trial {numbers[i]}: {changes[i].text}: loud for {time[i]:.1f} s, {loudest[i]:.1f} dB'
            )


if __name__ == '__main__':
    main()
