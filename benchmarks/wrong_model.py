# SPDX-FileCopyrightText: 2026 The satvib authors
# SPDX-License-Identifier: Apache-2.0
"""Law narrowband with a model whose phase at the tone is wrong: table and figure of docs/narrowband.md.

    ./satvib shell
    python benchmarks/wrong_model.py --page docs/narrowband.md --figures docs/figures

One strut, 20 Hz of 2 m/s^2, offline twin, seeds 1 to 10. The model that the strut has identified is turned at the tone
by a filter of two taps before the law gets it. Nothing tells the law.
"""

import argparse
from pathlib import Path

import matplotlib.pyplot as plt
import numpy as np
from satvib_common.arrays import Array
from satvib_common.levels import decibel
from satvib_common.phases import Phase
from satvib_control.laws.narrowband.model_correction import taps
from satvib_experiment.analysis.levels import tone_level
from satvib_experiment.scenario.scenario import load_scenario
from satvib_experiment.twin.closed_loop import ClosedLoop
from satvib_ident.models.iir_model import IirModel
from satvib_plant_sim.rig.rig import load_rig
from satvib_studies.sweep.tables import fill

RIGS = ('paper_1dof', 'clean_1dof')
DEGREES = (0, 30, 60, 66, 69, 72, 75, 78, 81, 85, 90, 120, 150, 180)
SHOWN = (0, 75, 120, 180)
SEEDS = range(1, 11)
FREQUENCY = 20.0
BEGIN, SETTLED = 8.0, 15.0  # s: CONTROL, the window that is judged


def turned(model: IirModel, degrees: Array) -> IirModel:
    """The model times a filter that turns it by degrees (items) at the tone and keeps its gain there."""
    omega = 2.0 * np.pi * FREQUENCY * model.dt
    b = [
        [np.convolve(strut, taps(np.exp(1j * np.radians(angle)), omega)) for strut in item]
        for item, angle in zip(model.b, degrees, strict=True)
    ]
    return IirModel(model.a, np.array(b), model.delay, model.dt)


def run(rig: str) -> tuple[Array, float, Array, float]:
    """Run all phase errors and seeds; give truth and voltage, (samples, errors, seeds), each with its spacing in s."""
    scenario = 'paper_1dof_20hz_narrowband'
    pairs = [(angle, seed) for angle in DEGREES for seed in SEEDS]
    scenarios = [load_scenario(scenario, [f'rig={rig}', f'seed={seed}']) for _, seed in pairs]
    loop = ClosedLoop(scenarios, [load_rig(rig)] * len(pairs))
    take = loop.controller.set_model
    degrees = np.array([float(angle) for angle, _ in pairs])

    def hand_over(model: IirModel, trusted: Array, why: object, covariance: Array) -> None:
        take(turned(model, degrees), trusted, why, covariance)

    loop.controller.set_model = hand_over
    y, u = [], []
    for step in loop.steps():
        if step.phase == Phase.CONTROL and not np.all(step.identification.converged):
            raise SystemExit(f'{rig}: a model is not trusted: {step.identification.reasons}')
        y.extend(step.truth.upper[:, 0].T)
        u.append(step.output.voltage[:, 0])
    trials, plant = (len(DEGREES), len(SEEDS)), loop.plant
    return (
        np.reshape(y, (-1, *trials)), plant.fine_period, np.reshape(u, (-1, *trials)), plant.dt,
    )  # fmt: skip


def rows(rig: str, y: Array, fine: float, u: Array, dt: float) -> list[str]:
    """The lines of the table."""
    before, begin, settled = (round(t / fine) for t in (5.0, BEGIN, SETTLED))
    quiet, acting, late = y[before:begin], y[begin:], y[settled:]
    gain = decibel(tone_level(late, fine, [FREQUENCY]), tone_level(quiet, fine, [FREQUENCY]))
    peak = np.abs(acting).max(axis=0) / np.abs(quiet).max(axis=0)
    pause = (u[round((BEGIN + 0.2) / dt) + 1 :] == 0.0).sum(axis=0) * dt
    return [
        f'| {rig} | {angle} | {np.median(gain[i]):.1f} | {gain[i].max():.1f} | {np.median(peak[i]):.2f} | '
        f'{peak[i].max():.2f} | {np.median(pause[i]):.1f} | {pause[i].max():.1f} |'
        for i, angle in enumerate(DEGREES)
    ]


def figure(y: Array, fine: float, path: Path) -> None:
    """Envelopes of the first seed, some phase errors."""
    drawing, axes = plt.subplots(figsize=(7.0, 3.2), layout='constrained')
    period = round(1.0 / FREQUENCY / fine)
    for angle in SHOWN:
        power = y[:, DEGREES.index(angle), 0] ** 2
        level = np.sqrt(np.convolve(power, np.ones(period) / period, 'same'))
        axes.semilogy(fine * np.arange(len(level)), level, label=f'{angle} degrees', lw=1.2)
    axes.axvline(BEGIN, color='0.6', lw=0.8)
    axes.set(
        xlim=(6.0, 14.0),
        ylim=(0.01, 8.0),
        xlabel='time [s]',
        ylabel='true RMS over a period [m/s²]',
    )
    axes.grid(True, which='major', alpha=0.3)
    axes.legend(title='the model is out by', loc='lower left')
    drawing.savefig(path, dpi=150)
    plt.close(drawing)


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument('--page', type=Path, help='page with the mark <!-- table wrong model -->')
    parser.add_argument('--figures', type=Path, help='folder for the figure')
    options = parser.parse_args()
    lines = [
        '| rig | out by [degrees] | tone, true [dB] | worst | largest, of open loop | worst | paused [s] | longest |',
        '|---|---:|---:|---:|---:|---:|---:|---:|',
    ]
    for rig in RIGS:
        y, fine, u, dt = run(rig)
        lines += rows(rig, y, fine, u, dt)
        if options.figures is not None and rig == RIGS[-1]:
            figure(y, fine, options.figures / 'narrowband_wrong_model.png')
    print('\n'.join(lines))
    if options.page is not None:
        fill(options.page, {'table wrong model': ''.join(line + '\n' for line in lines)})


if __name__ == '__main__':
    main()
