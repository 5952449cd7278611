# SPDX-FileCopyrightText: 2026 The satvib authors
# SPDX-License-Identifier: Apache-2.0
"""How much of several tones at once the laws leave, near each other and far apart.

    ./satvib shell
    python benchmarks/several_tones.py --page docs/narrowband.md

Sines of the base from 4.5 s, CONTROL from 6.5 s (phases and model as in `robustness.py`). The figure of a tone is its
true amplitude over that of the open loop, in dB, from 24 to 26 s: the worst strut, the median of seeds and the worst
of them.
"""

import argparse
import json
from pathlib import Path

import numpy as np
from satvib_common.arrays import Array
from satvib_experiment.scenario.scenario import Scenario, load_scenario
from satvib_experiment.twin.closed_loop import ClosedLoop
from satvib_studies.benchmark import robustness
from satvib_studies.sweep.tables import fill, plain_markdown

END = 26.0  # s
WINDOW = 2.0  # s
START = 4.5  # s
RIG = 'soft_3dof'
LAWS = ('narrowband', 'velocity_feedback+narrowband', 'feedforward')
TONES = (  # Hz: m/s^2 of the base
    {8.0: 0.5, 14.0: 0.5, 21.0: 0.5},
    {8.0: 0.5, 13.0: 0.4, 19.0: 0.5, 27.0: 0.3},
    {7.0: 0.3, 11.0: 0.5, 16.0: 0.3, 33.0: 0.5},
    {10.0: 0.5, 11.5: 0.5},
    {20.0: 0.5, 21.5: 0.5},
)


def scenario_of(law: str, tones: dict[float, float], seed: int) -> Scenario:
    """The scenario of one run."""
    sines = [
        {'kind': 'sine', 'frequency': f, 'amplitude': a, 'start': START} for f, a in tones.items()
    ]
    return load_scenario(
        RIG,
        [
            *robustness.RIGS[RIG],
            robustness.PHASES,
            f'duration={END}',
            f'seed={seed}',
            f'controller.law={law}',
            f'disturbance={json.dumps({"kind": "sum", "terms": sines})}',
            'analysis={}',
        ],
    )


def amplitudes(scenarios: list[Scenario], frequencies: list[float]) -> Array:
    """True amplitudes (tones, runs, struts) in the last window, m/s^2, by least squares."""
    loop = ClosedLoop(scenarios)
    first = round((END - WINDOW) / loop.plant.dt)
    kept = [step.truth.upper.mean(axis=-1) for step in loop.steps() if step.sequence >= first]
    y = np.array(kept)
    t = np.arange(len(y)) * loop.plant.dt
    waves = [wave(2.0 * np.pi * f * t) for f in frequencies for wave in (np.cos, np.sin)]
    regressor = np.column_stack([np.ones_like(t), *waves])
    parts = np.linalg.lstsq(regressor, y.reshape(len(y), -1), rcond=None)[0][1:]
    return np.hypot(parts[::2], parts[1::2]).reshape(-1, *y.shape[1:])


def main() -> None:
    """Print the table; fill it in."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument('--seeds', type=int, default=8)
    parser.add_argument('--laws', nargs='+', default=list(LAWS))
    parser.add_argument('--tones', nargs='+', type=int, default=list(range(len(TONES))))
    parser.add_argument('--page', type=Path, help='page with the mark "several tones"')
    options = parser.parse_args()
    seeds = range(1, 1 + options.seeds)
    rows = []
    for tones in (TONES[i] for i in options.tones):
        frequencies = list(tones)
        still = amplitudes([scenario_of('off', tones, s) for s in seeds], frequencies)
        row = [', '.join(f'{f:g} ({a:g})' for f, a in tones.items())]
        for law in options.laws:
            left = amplitudes([scenario_of(law, tones, s) for s in seeds], frequencies)
            worst = (20.0 * np.log10(left / still)).max(axis=-1)
            cells = [f'{np.median(of_tone):.0f} [{of_tone.max():+.0f}]' for of_tone in worst]
            row.append('; '.join(cells))
        rows.append(row)
        print(row, flush=True)
    table = plain_markdown(['tones in Hz (m/s^2)', *options.laws], rows)
    if options.page:
        fill(options.page, {'several tones': table})


if __name__ == '__main__':
    main()
