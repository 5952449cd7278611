# SPDX-FileCopyrightText: 2026 The satvib authors
# SPDX-License-Identifier: Apache-2.0
"""Figures of docs/narrowband.md, and its table of the tracker beside an AR(2) fit.

    ./satvib shell
    python benchmarks/active_suspension_figures.py [--figures docs/figures] [--page docs/narrowband.md]

The AR(2) fit is y(k) = 2 rho cos(w) y(k-1) - rho^2 y(k-2) by recursive least squares over all samples. Noise puts
power into y(k-1)^2 that no tone has, so the poles are drawn to the origin and the frequency to a quarter of the
sample rate.
"""

import argparse
import math
from pathlib import Path

import matplotlib as mpl

mpl.use('Agg')
import matplotlib.pyplot as plt
import numpy as np
from satvib_common.arrays import Array
from satvib_common.levels import decibel
from satvib_common.phases import Phase
from satvib_control.laws.base import LawInput
from satvib_control.laws.registry import make_law
from satvib_control.model_analysis.transfer import model_polynomials, respond
from satvib_control.parameters import ControllerParameters
from satvib_ident.estimators.least_squares import RecursiveLeastSquares
from satvib_ident.models.iir_model import IirModel
from satvib_studies.benchmark import active_suspension as bench
from satvib_studies.benchmark import active_suspension_protocol as asp
from satvib_studies.sweep.tables import fill

TRIALS, SECONDS, LATE = 24, 8.0, 6.0


def listen(y: Array) -> Array:
    """Frequency of the strongest tone that the law tracks at 0 V; `y` and the result (samples, trials), Hz."""
    count = y.shape[1]
    p = ControllerParameters(
        sample_rate=asp.RATE, law='narrowband', excitation_amplitude=0.0, **bench.SETTING
    )
    law = make_law('narrowband', p, 1.0 / asp.RATE, (count,))
    yes, nan, zero = np.ones(count, dtype=bool), np.full(count, np.nan), np.zeros(count)
    law.set_model(IirModel(np.zeros((count, 1)), np.ones((count, 1)), 1, 1.0 / asp.RATE), yes)
    out = np.full(y.shape, np.nan)
    for k, sample in enumerate(y):
        law.step(LawInput(k, sample, nan, zero, ~yes, yes), Phase.STANDBY)
        out[k] = law.state.frequency
    return out


def ar2(y: Array) -> Array:
    """Frequency of an AR(2) model by recursive least squares over all samples, (samples, trials), Hz."""
    count = y.shape[1]
    estimator = RecursiveLeastSquares(2, (count,))
    everybody = np.ones(count, dtype=bool)
    out = np.full(y.shape, np.nan)
    for k in range(2, len(y)):
        estimator.update(np.stack([-y[k - 1], -y[k - 2]], axis=-1), y[k], everybody)
        a1, a2 = estimator.theta[:, 0], estimator.theta[:, 1]
        cosine = np.clip(-a1 / (2.0 * np.sqrt(np.maximum(a2, 1e-12))), -1.0, 1.0)
        out[k] = np.arccos(cosine) * asp.RATE / (2.0 * np.pi)
    return out


def signals(frequency: float, kind: str) -> Array:
    """One tone in white noise of so many percent of its amplitude, or in the benchmark's own, (samples, trials)."""
    length = round(SECONDS * asp.RATE)
    rng = np.random.default_rng([bench.SEED, 31, round(10 * frequency)])
    t = np.arange(length)[:, None] / asp.RATE
    sine = np.sin(2.0 * np.pi * frequency * t + rng.uniform(0.0, 2.0 * np.pi, TRIALS))
    if kind != 'measured':
        percent = float(kind.split()[1])
        return np.asarray(sine + 0.01 * percent * rng.standard_normal(sine.shape))
    plant = asp.load_plant()
    z = np.exp(-2j * np.pi * frequency / asp.RATE)
    gain = abs(np.polyval(plant.primary_b[::-1], z) / np.polyval(plant.primary_a[::-1], z))
    noise = np.array([plant.segment(bench.SEED, 200 + i, length) for i in range(TRIALS)]).T
    return np.asarray(asp.AMPLITUDE * gain * sine + noise)


def bias(kinds: list[str]) -> dict[str, list[tuple[float, float, float, float, float]]]:
    """Per kind: frequency, then mean error and deviation of the tracker and of the AR(2) fit, Hz."""
    table: dict[str, list[tuple[float, float, float, float, float]]] = {}
    late = round(LATE * asp.RATE)
    for kind in kinds:
        for frequency in (50.0, 60.0, 72.5, 85.0, 95.0):
            y = signals(frequency, kind)
            cells = [frequency]
            for estimate in (listen(y), ar2(y)):
                last = estimate[late:].mean(axis=0)
                cells += [float(last.mean()) - frequency, float(last.std(ddof=1))]
            table.setdefault(kind, []).append(tuple(cells))  # type: ignore[arg-type]
    return table


def figure_tracker(
    folder: Path, table: dict[str, list[tuple[float, float, float, float, float]]]
) -> None:
    """Error of both estimators over the band."""
    fig, axes = plt.subplots(1, len(table), figsize=(4.0 * len(table), 3.2), squeeze=False)
    for ax, (kind, rows) in zip(axes[0], table.items(), strict=True):
        v = np.array(rows)
        for mean, deviation, label in ((1, 2, 'tracker'), (3, 4, 'AR(2) by least squares')):
            low = np.maximum(np.abs(v[:, mean]), v[:, deviation] / math.sqrt(TRIALS))
            ax.semilogy(v[:, 0], low, 'o-', label=label)
        ax.axhline(0.2, color='grey', lw=0.8, ls='--')
        ax.set(title=f'noise: {kind}', xlabel='frequency [Hz]', ylabel='|mean error| [Hz]')
        ax.grid(alpha=0.3)
        ax.legend(fontsize=8)
    fig.tight_layout()
    fig.savefig(folder / 'narrowband_tracker.png', dpi=110)


def figure_sequences(folder: Path, plant: asp.Plant, model: IirModel) -> None:
    """Residual force and tracked frequency under step changes and chirps."""
    cases = [asp.steps(1, 75.0, jump=10.0), asp.chirp()]
    fig, axes = plt.subplots(2, 2, figsize=(10.0, 5.0), sharex='col')
    for column, case in enumerate(cases):
        trials = bench.Trials(plant, model, [case], [[0]])
        t = np.arange(len(trials.open)) / asp.RATE
        top, bottom = axes[:, column]
        for y, label in ((trials.open, '0 V'), (trials.law, 'narrowband')):
            top.plot(t, 1e3 * y[:, 0], lw=0.4, label=label)
        top.set(title=case.name, ylabel='residual force [1e-3 V]', xlim=(4.0, t[-1]))
        top.legend(fontsize=8, loc='upper right')
        bottom.plot(t, case.tracks[0], 'k--', lw=1.0, label='true')
        bottom.plot(t, trials.frequency[:, 0], lw=0.9, label='tracked')
        bottom.set(xlabel='time [s]', ylabel='frequency [Hz]', ylim=(45.0, 100.0))
        bottom.legend(fontsize=8)
    fig.tight_layout()
    fig.savefig(folder / 'narrowband_sequences.png', dpi=110)


def figure_sensitivity(folder: Path, plant: asp.Plant, model: IirModel) -> None:
    """|S| of the settled law at the three levels: 1 - G Q with Q as in the docstring of `margin`."""
    b, a = model_polynomials(model)
    f = np.linspace(20.0, 150.0, 2601)
    z = np.exp(-2j * np.pi * f / asp.RATE)
    response = plant.response(f)
    g = 1.0 / (asp.PACE * asp.RATE)
    fig, ax = plt.subplots(figsize=(7.0, 3.4))
    for tones in ((75.0,), (60.0, 80.0), (50.0, 65.0, 80.0)):
        top, bottom = np.zeros(len(f), dtype=complex), np.ones(len(f), dtype=complex)
        for tone in tones:
            w = 2.0 * np.pi * (tone + 1e-3) / asp.RATE
            first, second = 1.0 / (1.0 - np.exp(1j * w) * z), 1.0 / (1.0 - np.exp(-1j * w) * z)
            k = 1.0 / respond(b, a, w)
            top += g * (k * first + np.conj(k) * second)
            bottom += g * (first + second - 2.0)
        s = np.abs(1.0 - response * top / bottom)
        ax.plot(f, decibel(s), label=', '.join(f'{x:g}' for x in tones) + ' Hz')
    ax.axhline(0.0, color='grey', lw=0.8)
    ax.set(xlabel='frequency [Hz]', ylabel='|S| [dB]', ylim=(-45.0, 10.0))
    ax.grid(alpha=0.3)
    ax.legend(fontsize=8)
    fig.tight_layout()
    fig.savefig(folder / 'narrowband_sensitivity.png', dpi=110)


def main() -> None:
    """Print the table, draw the figures."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument('--figures', type=Path, help='folder for the figures')
    parser.add_argument('--page', type=Path, help='page with the mark <!-- table tracker -->')
    options = parser.parse_args()
    there = asp.data_path().exists()
    table = bias(['white, 5 %', 'white, 20 %', *(['measured'] if there else [])])
    print(f'{TRIALS} trials of {SECONDS:g} s, mean of the last {SECONDS - LATE:g} s, mHz\n')
    names = ('tracker: bias', 'deviation', 'AR(2): bias', 'deviation of it')
    text = bench.markdown([
        {'noise': kind, 'frequency [Hz]': row[0]}
        | {name: f'{1e3 * v:.2f}' for name, v in zip(names, row[1:], strict=True)}
        for kind, rows in table.items()
        for row in rows
    ])  # fmt: skip
    print(text, end='')
    if options.page is not None:
        fill(options.page, {'table tracker': text})
    if options.figures is not None:
        options.figures.mkdir(parents=True, exist_ok=True)
        figure_tracker(options.figures, table)
        if there:
            plant = asp.load_plant()
            model = bench.exact(plant)
            figure_sequences(options.figures, plant, model)
            figure_sensitivity(options.figures, plant, model)


if __name__ == '__main__':
    main()
