# SPDX-FileCopyrightText: 2026 The satvib authors
# SPDX-License-Identifier: Apache-2.0
"""Tables and figures of docs/laws.md.

    ./satvib shell
    python benchmarks/control_laws.py                        # tables
    python benchmarks/control_laws.py --figures docs/figures # and figures

Everything comes from the packages: exact sampled models of the rigs, the offline twin of the live graph, seed 1.
"""

import argparse
from pathlib import Path

import matplotlib.pyplot as plt
import numpy as np
from satvib_common.arrays import Array, Complex
from satvib_common.levels import decibel
from satvib_common.signals.integrator import leaky_integrator
from satvib_control.laws.model_reference.rohrs import DT, UNSTABLE, simulate
from satvib_control.model_analysis.dominant_mode import polarity
from satvib_control.model_analysis.gain_bounds import gain_bounds
from satvib_control.model_analysis.margins import loop_response, margins
from satvib_experiment.scenario.scenario import load_scenario
from satvib_experiment.twin.closed_loop import ClosedLoop
from satvib_ident.models.iir_model import IirModel
from satvib_plant_sim.responses.one_strut import SampledModel, discrete_strut_model
from satvib_plant_sim.rig.rig import load_rig

CORNER = 0.5
COLOURS = ('#0072B2', '#D55E00', '#009E73', '#CC79A7', '#E69F00')
plt.rcParams.update({
    'font.size': 9, 'axes.grid': True, 'grid.color': '#dddddd', 'axes.spines.top': False,
    'axes.spines.right': False, 'legend.frameon': False, 'figure.dpi': 110,
})  # fmt: skip


def sampled_strut(rig: str, rate: float | None = None) -> SampledModel:
    """The exact sampled first strut; at another rate with the filter matched to it."""
    overrides: dict[str, float] = {}
    if rate is not None:
        fine = rate * max(1, round(4000.0 / rate))
        overrides |= {'acquisition.sample_rate': rate, 'acquisition.fine_rate': fine}
        if rig != 'paper_3dof':
            overrides['acquisition.filter_corner'] = 0.35 * rate
    return discrete_strut_model(load_rig(rig, overrides))


def model_of(sampled: SampledModel) -> IirModel:
    """Give it as coefficients."""
    a, b, delay = sampled.coefficients()
    return IirModel(a, b, delay, sampled.dt)


def rig_loop(sampled: SampledModel, gain: float, f: Array) -> Complex:
    """L = K H G at f (Hz), with the rig's own response, not with the coefficients of a model."""
    law = leaky_integrator(CORNER, sampled.dt)
    return loop_response(sampled.response(f), *law, gain, 2.0 * np.pi * f * sampled.dt)


def best_gain(model: IirModel, margin: float = 0.5) -> float:
    c = leaky_integrator(CORNER, model.dt)
    bounds = gain_bounds(model, *c, margin)
    return float(np.where(polarity(model, *c) > 0.0, bounds.maximum, bounds.minimum))


REACH = (
    ('paper_3dof', None), ('paper_3dof', 200.0), ('clean_3dof', None), ('clean_3dof', 500.0),
    ('clean_3dof', 1000.0), ('soft_3dof', None), ('soft_3dof', 1000.0),
)  # fmt: skip


def reach() -> None:
    """What velocity feedback can reach at all: the bound of the true sampled plant."""
    print('\nVelocity feedback at its bound (modulus margin 0.5), from the exact sampled model')
    print(
        '| rig | rate [Hz] | K [V/(m/s)] | 9 Hz [dB] | 10 Hz [dB] | 20 Hz [dB] | delay margin [ms] |'
    )
    print('|---|---|---|---|---|---|---|')
    for rig, rate in REACH:
        sampled = sampled_strut(rig, rate)
        model = model_of(sampled)
        gain = best_gain(model)
        s = -decibel(np.abs(1.0 + rig_loop(sampled, gain, np.array([9.0, 10.0, 20.0]))))
        margin = margins(model, *leaky_integrator(CORNER, model.dt), gain)
        late = f'{float(margin.delay) * 1e3:.1f}' if np.isfinite(margin.delay) else '|L| < 1'
        figures = ' | '.join(f'{x:.1f}' for x in s)
        print(f'| {rig} | {1.0 / model.dt:.0f} | {gain:.0f} | {figures} | {late} |')


class Trace:
    """A scenario in the offline twin, with what the figures need."""

    def __init__(self, name: str, *overrides: str) -> None:
        self.scenario = load_scenario(name, list(overrides))
        loop = ClosedLoop(self.scenario)
        self.dt = loop.plant.dt
        rows = {
            key: [] for key in ('measured', 'true', 'voltage', 'ki', 'model', 'error', 'adapting')
        }
        for step in loop.steps():
            out = step.output
            rows['measured'].append(step.sample.upper - out.bias_upper)
            rows['true'].append(step.truth.upper)
            rows['voltage'].append(out.voltage)
            rows['ki'].append(out.state.ki)
            rows['model'].append(out.state.model_output)
            rows['error'].append(out.state.error)
            rows['adapting'].append(out.adapting)
        self.state, self.reason = out.state, out.reason_text((0,))
        for key, value in rows.items():
            setattr(self, key, np.array(value))
        self.t = np.arange(len(self.voltage)) * self.dt

    def gain_db(self, values: Array) -> Array:
        """RMS, controlled over uncontrolled, dB by strut."""
        windows = self.scenario.analysis.uncontrolled, self.scenario.analysis.controlled
        power = []
        for begin, end in windows:
            part = values[(self.t >= begin) & (self.t < end)] ** 2
            power.append(part.mean(axis=0) if part.ndim == 2 else part.mean(axis=(0, 2)))
        return 10.0 * np.log10(power[1] / power[0])


def laws_on_rigs() -> None:
    """The two laws of the paper on the rigs, as measured and in truth."""
    print(
        '\nThe laws of the paper in the offline twin, RMS with control over without, seed 1, worst strut'
    )
    print(
        '| scenario | law | K_i [V/(m/s)] | measured [dB] | truth [dB] | largest voltage [V] | reason |'
    )
    print('|---|---|---|---|---|---|---|')
    runs = []
    for name in ('paper_1dof_10hz', 'paper_1dof_20hz', 'paper_3dof', 'clean_3dof', 'soft_3dof'):
        for law in ('velocity_feedback', 'model_reference'):
            extra = ['controller.law=' + law]
            if law == 'velocity_feedback':
                extra.append('controller.velocity_gain=2000.0')
            runs.append((name, law, extra))
        if name.startswith('paper_1dof'):
            runs.append((name, 'velocity_feedback', ['controller.law=velocity_feedback']))
    for name, law, extra in runs:
        trace = Trace(name, *extra)
        gains = ', '.join(f'{k:.0f}' for k in trace.state.ki)
        late = trace.t >= trace.scenario.analysis.controlled[0]
        print(
            f'| {name} | {law} | {gains} | {np.max(trace.gain_db(trace.measured)):.1f} | '
            f'{np.max(trace.gain_db(trace.true)):.1f} | {np.max(np.abs(trace.voltage[late])):.1f} | '
            f'{trace.reason} |'
        )


def figure_bounds(folder: Path) -> None:
    """Nyquist curves at the bound, with the disc that they must not enter."""
    fig, axes = plt.subplots(1, 3, figsize=(9.5, 3.4))
    for ax, (rig, rate) in zip(
        axes, (('paper_3dof', None), ('clean_3dof', None), ('soft_3dof', None)), strict=True
    ):
        sampled = sampled_strut(rig, rate)
        model = model_of(sampled)
        f = np.geomspace(0.02, 0.5 / model.dt, 6000)
        gain = best_gain(model)
        for share, colour in ((1.0, COLOURS[0]), (1.4, COLOURS[1])):
            curve = rig_loop(sampled, share * gain, f)
            ax.plot(
                curve.real,
                curve.imag,
                color=colour,
                lw=1.2,
                label=f'K = {share * gain:.0f} V/(m/s)',
            )
        ax.add_patch(plt.Circle((-1.0, 0.0), 0.5, fill=False, color='#444444', ls='--', lw=1.0))
        ax.plot(-1.0, 0.0, '+', color='#444444')
        ax.set(
            title=f'{rig}, {1.0 / model.dt:.0f} Hz',
            xlim=(-2.2, 3.0),
            ylim=(-2.4, 2.4),
            xlabel='Re L',
        )
        ax.set_aspect('equal')
        ax.legend(loc='lower right', fontsize=8)
    axes[0].set_ylabel('Im L')
    fig.tight_layout()
    fig.savefig(folder / 'gain_bounds.png')


def figure_reach(folder: Path) -> None:
    """|S| of velocity feedback at its bound."""
    fig, axes = plt.subplots(1, 2, figsize=(9.5, 3.2), sharey=True)
    for ax, rig, rates in (
        (axes[0], 'clean_3dof', (100.0, 200.0, 500.0, 1000.0)),
        (axes[1], 'soft_3dof', (100.0, 200.0, 500.0, 1000.0)),
    ):
        for rate, colour in zip(rates, COLOURS, strict=False):
            sampled = sampled_strut(rig, rate)
            f = np.geomspace(1.0, 0.499 / sampled.dt, 1500)
            s = -decibel(np.abs(1.0 + rig_loop(sampled, best_gain(model_of(sampled)), f)))
            ax.semilogx(f, s, color=colour, lw=1.3, label=f'{rate:.0f} Hz')
        ax.axhline(0.0, color='#444444', lw=0.8)
        ax.set(title=rig, xlabel='frequency [Hz]', ylim=(-40.0, 10.0))
    axes[0].set_ylabel('vibration with over without control [dB]')
    axes[0].legend(title='sample rate')
    fig.tight_layout()
    fig.savefig(folder / 'velocity_feedback_reach.png')


def figure_adaptation(folder: Path) -> None:
    """The paper's sequence: K_i finds its value in ADAPT, plant and reference model meet."""
    trace = Trace('paper_3dof', 'controller.law=model_reference')
    fig, (top, bottom) = plt.subplots(2, 1, figsize=(9.5, 4.6), sharex=True)
    for i, colour in zip(range(trace.ki.shape[1]), COLOURS, strict=False):
        top.plot(trace.t, trace.ki[:, i], color=colour, lw=1.3, label=f'strut {i + 1}')
    top.axhline(float(trace.state.ki_max[0]), color='#444444', ls='--', lw=1.0, label='bound')
    top.set(ylabel='K_i [V/(m/s)]', title='paper_3dof, ADAPT from 3 s to 5 s')
    top.legend(ncol=4, loc='lower right')
    bottom.plot(trace.t, trace.measured[:, 0], color=COLOURS[1], lw=1.0, label='strut 1, measured')
    bottom.plot(trace.t, trace.model[:, 0], color=COLOURS[0], lw=1.0, label='reference model')
    bottom.set(xlim=(2.8, 5.0), ylim=(-3.0, 3.0), xlabel='time [s]', ylabel='acceleration [m/s²]')
    bottom.legend(ncol=2, loc='upper right')
    fig.tight_layout()
    fig.savefig(folder / 'model_reference.png')


def figure_rohrs(folder: Path) -> None:
    """The gain of Rohrs' example under five rules."""
    fig, ax = plt.subplots(figsize=(9.5, 3.0))
    cases = (
        ('plain rule', {}), ('sigma modification', {'sigma': 0.1}), ('e1 modification', {'nu': 0.1}),
        ('dead zone', {'dead_zone': 0.6}), ('projection', {'bound': 10.0}),
    )  # fmt: skip
    for (label, robust), colour in zip(
        cases, ('#D55E00', '#0072B2', '#009E73', '#CC79A7', '#E69F00'), strict=True
    ):
        _, theta = simulate(120.0, **robust)
        ax.plot(np.arange(len(theta)) * DT, theta[:, 1], color=colour, lw=1.3, label=label)
    ax.axhline(UNSTABLE, color='#444444', ls='--', lw=1.0, label='unstable above')
    ax.set(
        xlabel='time [s]', ylabel='feedback gain', ylim=(0.0, 25.0), title="Rohrs' counter-example"
    )
    ax.legend(ncol=3, fontsize=8)
    fig.tight_layout()
    fig.savefig(folder / 'rohrs.png')


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument('--figures', type=Path, help='folder for the figures')
    options = parser.parse_args()
    reach()
    laws_on_rigs()
    if options.figures is not None:
        options.figures.mkdir(parents=True, exist_ok=True)
        for figure in (figure_bounds, figure_reach, figure_adaptation, figure_rohrs):
            figure(options.figures)


if __name__ == '__main__':
    main()
