# SPDX-FileCopyrightText: 2026 The satvib authors
# SPDX-License-Identifier: Apache-2.0
"""The drift under the paper's Fig. 7: velocity from a measured acceleration, with and without a leak.

    ./satvib shell
    python benchmarks/velocity_drift.py --page docs/paper.md --figures docs/figures

The acceleration is that of `paper_1dof_10hz` at 0 V, seed 1, with its bias learnt in CALIBRATE. The true velocity is
the integral of the acceleration on the fine grid, without its mean.
"""

import argparse
from pathlib import Path

import matplotlib.pyplot as plt
import numpy as np
from satvib_common.arrays import Array
from satvib_common.signals.integrator import leaky_integrator
from satvib_experiment.recording.signals import fine, without_bias
from satvib_experiment.scenario.scenario import load_scenario
from satvib_experiment.twin.closed_loop import simulate
from satvib_studies.sweep.tables import fill, plain_markdown
from scipy.integrate import cumulative_trapezoid
from scipy.signal import lfilter

GAIN = 56.1  # V/(m/s); the paper's 550, read as V per g s
LONG = 120.0  # s
CORNER = 0.5  # Hz
# what CALIBRATE leaves of a bias in a second of 10 mg noise; and a drift with temperature
REMAINING = {'bias learnt in CALIBRATE': 0.0, 'and 3 mg of drift since': 2.941995e-2}


def accelerations() -> tuple[Array, Array, float, float]:
    """Measured (samples) without bias, true (fine samples), both in m/s^2, and their periods in s."""
    settings = ['controller.law=off', f'duration={LONG}', 'analysis={}']
    run = simulate(load_scenario('paper_1dof_10hz', settings))
    measured = without_bias(run, slice(None))[:, 0]
    return measured, fine(run, slice(None))[:, 0], run.sample_period, run.fine_period


def main() -> None:
    """Print the table, draw the figure."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument('--page', type=Path, help='page with the mark of the table')
    parser.add_argument('--figures', type=Path, help='folder for the figure')
    options = parser.parse_args()
    measured, true, dt, fine_dt = accelerations()
    begin = round(2.0 / dt)  # CALIBRATE is over
    measured = measured[begin:]
    t = np.arange(len(measured)) * dt
    velocity = cumulative_trapezoid(true[round(2.0 / fine_dt) :], dx=fine_dt, initial=0.0)
    velocity -= velocity.mean()
    rows, lines = [], []
    for name, bias in REMAINING.items():
        pure = cumulative_trapezoid(measured + bias, dx=dt, initial=0.0)
        leaky = lfilter(*leaky_integrator(CORNER, dt), measured + bias)
        lines.append((name, pure, leaky))
        for kind, v in (('integral', pure), ('with the leak', leaky)):
            late = v[-round(10.0 / dt) :]
            rows.append([
                name, kind, f'{1e3 * late.mean():.2f}', f'{1e3 * late.std():.2f}',
                f'{GAIN * late.mean():.2f}',
            ])  # fmt: skip
    rows.append(['none', 'truth', '0.00', f'{1e3 * velocity.std():.2f}', '0.00'])
    heads = ['bias that is left', 'velocity', 'mean [mm/s]', 'deviation [mm/s]', 'mean voltage [V]']
    table = plain_markdown(heads, rows)
    print(table)
    if options.page is not None:
        fill(options.page, {'table drift': table})
    if options.figures is not None:
        figure, ax = plt.subplots(figsize=(9.5, 3.4), dpi=110)
        for (name, pure, leaky), colour in zip(lines, ('#0072B2', '#D55E00'), strict=True):
            ax.plot(t, GAIN * pure, color=colour, lw=1.0, label=f'integral, {name}')
            ax.plot(t, GAIN * leaky, color=colour, lw=0.6, ls='--', label=f'leak, {name}')
        ax.axhline(20.0, color='#444444', lw=0.8)
        ax.set(xlabel='time [s]', ylabel='voltage that it asks for [V]')
        ax.legend(fontsize=8)
        ax.grid(color='#dddddd')
        figure.tight_layout()
        figure.savefig(options.figures / 'velocity_drift.png')


if __name__ == '__main__':
    main()
