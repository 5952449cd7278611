# SPDX-FileCopyrightText: 2026 The satvib authors
# SPDX-License-Identifier: Apache-2.0
"""The worst of many drawn changes, run again as live graphs: equal to the offline twin, bit for bit?

./satvib shell
python benchmarks/changes_live.py --trials 200 --worst 20
python benchmarks/changes_live.py --run soft_3dof:feedforward:48 paper_1dof:feedforward:101
"""

import argparse
import tempfile
from pathlib import Path

from changes import LAWS
from satvib_bringup.live.run import run_experiment
from satvib_experiment.recording.bag_reader import read_recording
from satvib_experiment.recording.recording import differences
from satvib_experiment.twin.closed_loop import simulate
from satvib_plant_sim.rig.rig import load_rig
from satvib_studies.changes import draw_change, run_changes
from satvib_studies.changes.runs import RIGS, scenario_of


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument('--trials', type=int, default=100, help='of each rig and law')
    parser.add_argument('--worst', type=int, default=20)
    parser.add_argument('--rigs', nargs='+', default=list(RIGS), choices=list(RIGS))
    parser.add_argument('--laws', nargs='+', default=list(LAWS))
    parser.add_argument('--run', nargs='+', default=[], metavar='RIG:LAW:TRIAL')
    parser.add_argument('--composition', default='single')
    options = parser.parse_args()
    chosen = [(rig, law, int(trial)) for rig, law, trial in (run.split(':') for run in options.run)]
    print('| rig | law | trial | change | fields that differ from the twin |')
    print('|---|---|---:|---|---:|', flush=True)
    for rig, law, trial in chosen or worst_of(options):
        show(rig, law, trial, options.composition)


def worst_of(options: argparse.Namespace) -> list[tuple[str, str, int]]:
    """Rig, law and trial of the trials that were loud for longest, then loudest."""
    found = []
    trials = range(1, options.trials + 1)
    for rig in options.rigs:
        for law in options.laws:
            outcome = run_changes(rig, law, trials)
            found += [
                (-time, -loudest, rig, law, trial)
                for time, loudest, trial in zip(
                    outcome.loud_time, outcome.loudest, trials, strict=True
                )
            ]
    return [(rig, law, trial) for _, _, rig, law, trial in sorted(found)[: options.worst]]


def show(rig: str, law: str, trial: int, composition: str) -> None:
    change = draw_change(load_rig(rig), trial)
    scenario = scenario_of(rig, law, change, trial)
    with tempfile.TemporaryDirectory() as folder:
        outcome = run_experiment(
            scenario.replace(composition=composition), Path(folder) / 'run', record=True
        )
        if outcome.success:
            found = str(len(differences(read_recording(outcome.bag), simulate(scenario))))
        else:
            found = outcome.message
    print(f'| {rig} | {law} | {trial} | {change.text} | {found} |', flush=True)


if __name__ == '__main__':
    main()
