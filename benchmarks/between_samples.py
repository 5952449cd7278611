# SPDX-FileCopyrightText: 2026 The satvib authors
# SPDX-License-Identifier: Apache-2.0
"""Tables of docs/between_samples.md that are no sweep: models, second channels, and the payload served.

    ./satvib shell
    python benchmarks/between_samples.py --page docs/between_samples.md

`--only serving` makes one table alone. The second channel is made from the truth of a run: noise of the sensor's
density, a low-pass and a rate of its own.
"""

import argparse
import math
from pathlib import Path

import numpy as np
from model_phase import HEAD, ORDERS, RATES, Case, row
from satvib_common.arrays import Array
from satvib_common.levels import decibel, rms
from satvib_experiment.analysis.evaluation import evaluate
from satvib_experiment.analysis.levels import tone_level
from satvib_experiment.recording.signals import fine
from satvib_experiment.scenario.scenario import load_scenario
from satvib_experiment.twin.closed_loop import simulate, simulate_open_loop
from satvib_plant_sim.responses.periodic import best_command
from satvib_studies.sweep.tables import fill, plain_markdown
from scipy.signal import butter, sosfilt

SEEDS = range(1, 6)
# rate of the channel in Hz, order and corner of its filter
CHANNELS = ((100.0, 1, 50.0), (500.0, 2, 175.0), (1000.0, 2, 350.0), (2000.0, 2, 700.0))
NOISES = {'10 mg': 0.0980665, '0.1 mg': 9.80665e-4}


def whole_delay(latency: float, rate: float) -> int:
    """One sample, and the whole periods of the latency (s)."""
    return math.floor(latency * rate + 1e-9) + 1


def models() -> str:
    """Phase errors of identified models."""
    lines = [HEAD]
    for excitation in ('chirp', 'prbs', 'squares'):
        for rate in RATES:
            for poles, coefficients in ORDERS if excitation == 'chirp' else ((2, 3), (6, 7)):
                lines.append(row(Case(rate, 'matched', excitation, poles, coefficients), SEEDS))
    lines += [
        row(Case(rate, '50 Hz', 'chirp', 4, 5, delay=whole_delay(1e-3, rate)), SEEDS)
        for rate in RATES
    ]
    for rate in (500.0, 1000.0):
        for delay in (1, whole_delay(5e-3, rate)):
            case = Case(rate, 'matched', 'chirp', 6, 7, delay=delay, latency=5e-3)
            lines.append(row(case, SEEDS))
    return '\n'.join(lines) + '\n'


def channel(true: Array, dt: float, rate: float, order: int, corner: float, noise: float) -> Array:
    """What a second accelerometer reads, (samples, struts).

    Args:
        true: (fine samples, struts), m/s^2.
        dt: s, of the fine grid.
        rate: Hz, of the channel.
        order, corner: of its low-pass; corner in Hz.
        noise: RMS in m/s^2 of a sensor of 100 Hz bandwidth; a wider channel has more of it.
    """
    rng = np.random.default_rng([7, round(rate)])
    density = noise / math.sqrt(100.0)
    read = true + density * math.sqrt(0.5 / dt) * rng.standard_normal(true.shape)
    low = sosfilt(butter(order, corner, fs=1.0 / dt, output='sos'), read, axis=0)
    return np.asarray(low[:: round(1.0 / (rate * dt))])


def own_truth() -> str:
    """Second channels beside the loop's own samples and the truth."""
    scenario = load_scenario(
        'clean_3dof_narrowband',
        [
            'rig.acquisition.sample_rate=100', 'rig.acquisition.hold=zero',
            'rig.acquisition.filter_order=1', 'rig.acquisition.filter_corner=50',
            'identifier={poles: 4, coefficients: 5}',
        ],
    )  # fmt: skip
    run = simulate(scenario)
    idle = simulate_open_loop(run)
    window = run.window(*scenario.analysis.controlled)
    rows = []

    def add(name: str, noise: str, after: Array, before: Array, dt: float) -> None:
        attenuation = decibel(rms(after), rms(before))
        tone = decibel(tone_level(after, dt, [10.0]), tone_level(before, dt, [10.0]))
        rows.append([name, noise, f'{np.max(attenuation):.1f}', f'{np.max(tone):.1f}'])

    measured = [each.get('acceleration', 'upper')[window] for each in (run, idle)]
    add("the loop's own samples, 100 Hz", '0.1 mg', *measured, run.sample_period)
    true = [fine(each, window) for each in (run, idle)]
    for noise, value in NOISES.items():
        for rate, order, corner in CHANNELS:
            read = [channel(t, run.fine_period, rate, order, corner, value) for t in true]
            after, before = (r[round(0.5 * rate) :] for r in read)  # the filter settles
            name = f'second channel, {rate:.0f} Hz, order {order} at {corner:.0f} Hz'
            add(name, noise, after, before, 1.0 / rate)
    add('truth', 'none', *true, run.fine_period)
    return plain_markdown(['seen by', 'noise', 'RMS [dB]', 'tone [dB]'], rows)


# settings of an acquisition with steps at 100 Hz, by name
SLOW = {
    'paper_3dof': ('paper_3dof_narrowband', []),
    'clean_3dof, matched filter': (
        'clean_3dof_narrowband',
        ['rig.acquisition.filter_corner=35', 'identifier={poles: 6, coefficients: 7}'],
    ),
    'clean_3dof, 50 Hz filter': (
        'clean_3dof_narrowband',
        [
            'rig.acquisition.filter_order=1', 'rig.acquisition.filter_corner=50',
            'identifier={poles: 4, coefficients: 5}',
        ],
    ),
}  # fmt: skip
TONES = ((6.5, 200), (10.0, 10), (20.0, 5))  # Hz; samples after which a held command repeats


def serving() -> str:
    """Law narrowband serving the samples or the payload, beside the best periodic command."""
    rows = []
    for name, (scenario, settings) in SLOW.items():
        slow = ['rig.acquisition.sample_rate=100', 'rig.acquisition.hold=zero', *settings]
        for frequency, period in TONES:
            cells = []
            for serve in ('samples', 'payload'):
                own = [f'disturbance.frequency={frequency}', f'controller.narrowband_serve={serve}']
                run = simulate(load_scenario(scenario, [*slow, *own]))
                found = evaluate(run, simulate_open_loop(run)).attenuation_open_loop
                late = run.get('voltage', 'voltage')[run.window(20.0, 25.0)]
                volts = float(np.max(np.abs(late)))
                cells += [f'{np.max(found[f"{kind}_rms"]):.1f}' for kind in ('measured', 'true')]
                cells.append(f'{volts:.1f}')
            assert run.rig is not None
            rows.append(
                [
                    name,
                    f'{frequency:g}',
                    f'{np.max(best_command(run.rig, frequency, period)):.1f}',
                    *cells,
                ]
            )
    heads = ['rig', 'tone [Hz]', 'best command, true']
    for serve in ('samples', 'payload'):
        heads += [f'{serve}: measured', f'{serve}: true', f'{serve}: peak [V]']
    return plain_markdown(heads, rows)


TABLES = {'own_truth': own_truth, 'model_phase': models, 'serving': serving}


def main() -> None:
    """Print the tables and write them into the page."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument('--page', type=Path, help='page with the marks of the tables')
    parser.add_argument('--only', choices=TABLES, help='one table alone')
    options = parser.parse_args()
    names = [options.only] if options.only else list(TABLES)
    tables = {f'table {name}': TABLES[name]() for name in names}
    for text in tables.values():
        print(text)
    if options.page is not None:
        fill(options.page, tables)


if __name__ == '__main__':
    main()
