# SPDX-FileCopyrightText: 2026 The satvib authors
# SPDX-License-Identifier: Apache-2.0
"""Tables and figure of docs/feedforward.md.

    ./satvib shell
    python benchmarks/feedforward.py --page docs/feedforward.md

What feedforward achieves on each rig, beside what its reference allows: the coherence bound (any filter, causal or
not), and the causal Wiener optimum (the best filter of this very form), found on the first half of a record at 0 V and
judged on the second, without a leak and with that of the law. Seed 1, offline twin, random vibration of 0.7 m/s^2, 2 to
50 Hz.
"""

import argparse
from dataclasses import dataclass
from pathlib import Path

import matplotlib.pyplot as plt
import numpy as np
from satvib_common.arrays import Array
from satvib_common.errors import SatvibError
from satvib_common.levels import decibel
from satvib_control.laws.feedforward.wiener import (
    CoherenceBound,
    WienerOptimum,
    coherence_bound,
    regressors,
    wiener_optimum,
)
from satvib_experiment.analysis.levels import spectrum
from satvib_experiment.scenario.scenario import load_scenario
from satvib_experiment.twin.closed_loop import ClosedLoop
from satvib_ident.models.iir_model import IirModel
from satvib_plant_sim.plant.any_plant import make_plant
from satvib_studies.sweep.tables import fill, plain_markdown

SETTINGS = {
    'paper_1dof': ('identifier={poles: 4, coefficients: 5}', 'controller.excitation=chirp'),
    'paper_3dof': ('identifier={poles: 4, coefficients: 5}', 'controller.excitation=chirp'),
    'clean_3dof': ('identifier={poles: 6, coefficients: 7}', 'controller.excitation=chirp'),
    'soft_3dof': (
        'identifier={poles: 6, coefficients: 7}', 'controller.excitation=squares',
        'controller.excitation_amplitude=2.0',
    ),
}  # fmt: skip
METHODS = ('fxrls', 'fxlms', 'filtered_u')
BEGIN, LEARNT, END = 8.0, 26.0, 56.0  # s: CONTROL, the window that is judged
PHASES = (
    'phases=[{phase: CALIBRATE}, {phase: IDENTIFY, start: 1.0}, {phase: STANDBY, start: 4.0}, '
    f'{{phase: CONTROL, start: {BEGIN}}}]'
)
RANDOM = 'disturbance={kind: random, rms: 0.7, low: 2.0, high: 50.0, start: 6.0}'
TAPS, LEAK = 16, 1e-3
# s of the open loop for the bound, and samples of a block: several times rate / (damping frequency) of the mode
LONG, BLOCK = 600.0, {'soft_3dof': 2048}
FIGURE_RIGS = ('clean_3dof', 'soft_3dof')


@dataclass(frozen=True)
class Run:
    """One run, first strut first: samples without bias (t, struts), truth (t, struts, fine), what the law said."""

    upper: Array
    lower: Array
    true: Array
    voltage: Array
    model: IirModel
    dt: float
    said: frozenset[str]

    def window(self) -> slice:
        """The samples that are judged."""
        return slice(round(LEARNT / self.dt), round(END / self.dt))


def run(rig: str, law: str, *changes: str) -> Run:
    """Run a rig under a law."""
    scenario = load_scenario(
        'clean_1dof_10hz' if '1dof' in rig else 'clean_3dof',
        [
            f'rig={rig}', *SETTINGS[rig], 'analysis={}', f'duration={END}', RANDOM,
            PHASES,
            f'controller.law={law}', *changes,
        ],
    )  # fmt: skip
    loop = ClosedLoop(scenario)
    rows: list[tuple[Array, ...]] = []
    said = set()
    for step in loop.steps():
        out, sample = step.output, step.sample
        rows.append(
            (
                sample.upper - out.bias_upper,
                sample.lower - out.bias_lower,
                step.truth.upper,
                out.voltage,
            )
        )
        if step.sequence * loop.plant.dt > LEARNT:
            said |= {out.reason_text((strut,)) for strut in range(loop.plant.struts)}
    upper, lower, true, voltage = (np.array(column) for column in zip(*rows, strict=True))
    model = step.identification.model()
    return Run(upper, lower, true, voltage, model, loop.plant.dt, frozenset(said - {''}))


def passive(rig: str) -> tuple[Array, Array, float]:
    """Lower and upper (t, struts) of a long record at 0 V, and dt."""
    scenario = load_scenario(
        'clean_1dof_10hz' if '1dof' in rig else 'clean_3dof', [f'rig={rig}', 'analysis={}', RANDOM]
    )
    plant = make_plant(scenario.load_rig(), scenario.make_disturbance(), scenario.seed)
    silence = np.zeros(plant.struts)
    first, count = round(BEGIN / plant.dt), round((BEGIN + LONG) / plant.dt)
    found = np.zeros((2, count, plant.struts))
    for k in range(count):
        sample = plant.sample()
        found[:, k] = sample.lower, sample.upper
        plant.advance(silence)
    return found[0, first:], found[1, first:], plant.dt


def bounds(rig: str) -> list[CoherenceBound]:
    """The coherence bound of each strut."""
    lower, upper, dt = passive(rig)
    block = BLOCK.get(rig, 512)
    return [
        coherence_bound(lower[:, i], upper[:, i], 1.0 / dt, block) for i in range(lower.shape[1])
    ]


def optimum(idle: Run, strut: int, leak: float) -> WienerOptimum:
    """The best weights; from rest, so that no transient of the filters is in them."""
    rest = slice(round(5.5 / idle.dt), None)
    return wiener_optimum(
        idle.lower[rest, strut], idle.upper[rest, strut], idle.model[strut], TAPS, leak=leak
    )


def level(values: Array) -> Array:
    """RMS per strut."""
    axes = (0,) if values.ndim == 2 else (0, 2)
    return np.sqrt(np.mean(values**2, axis=axes))


def worst(after: Array, before: Array) -> float:
    """Attenuation of the worst strut, dB."""
    return float(decibel(np.max(level(after) / level(before))))


def reach() -> str:
    """What the methods achieve, beside optimum and bound."""
    rows = []
    for rig in SETTINGS:
        idle = run(rig, 'off')
        w = idle.window()
        struts = range(idle.upper.shape[1])
        found = bounds(rig)
        best = [optimum(idle, i, 0.0) for i in struts]
        leaky = [optimum(idle, i, LEAK) for i in struts]
        floor = -10.0 * np.log10(found[0].blocks)
        total = max(b.total for b in found)
        cells = [
            f'{total:.1f}' if total > floor + 1.0 else f'below {floor:.0f}',
            f'{max(b.attenuation for b in best):.1f}',
            f'{max(b.attenuation for b in leaky):.1f}',
        ]
        for method in METHODS:
            with_law = run(rig, 'feedforward', f'controller.feedforward_method={method}')
            cells.append(
                f'{worst(with_law.upper[w], idle.upper[w]):.1f} / {worst(with_law.true[w], idle.true[w]):.1f}'
            )
        rows.append([rig, *cells, f'{max(b.voltage_peak for b in best):.1f}'])
    heads = [
        'rig',
        'coherence bound',
        'Wiener optimum',
        'with the leak',
        *METHODS,
        'peak voltage of the optimum [V]',
    ]
    return plain_markdown(heads, rows)


PROTECTED = 'controller.feedforward_protection_time=0.04'
BARE = 'controller.feedforward_protection_time=0.0'
CASES = (
    ('as it is', PROTECTED, 3), ('no protection', BARE, 3),
    ('protection, other struts not counted', PROTECTED, 1),
)  # fmt: skip
SHAKERS = (('8e6 N/m, as in the rig', 8.0e6), ('2e6 N/m', 2.0e6), ('8e5 N/m', 8.0e5))


def protection() -> str:
    """A reference that hears the strut's own reaction: softer and softer shakers."""
    rows = []
    for rig in ('clean_1dof', 'clean_3dof'):
        SETTINGS.setdefault(rig, SETTINGS['paper_1dof'])
        for label, stiffness in SHAKERS:
            shaker = f'rig.shaker.stiffness={stiffness}'
            idle = run(rig, 'off', shaker)
            w = idle.window()
            for name, setting, struts in CASES:
                if rig == 'clean_1dof' and struts == 1 and name.endswith('counted'):
                    continue
                count = 1 if rig == 'clean_1dof' else struts
                with_law = run(
                    rig, 'feedforward', shaker, setting, f'controller.feedforward_struts={count}'
                )
                rows.append([
                    rig, label, name, f'{worst(with_law.upper[w], idle.upper[w]):.1f}',
                    f'{np.max(np.abs(with_law.voltage[w])):.1f}', '; '.join(sorted(with_law.said)) or '-',
                ])  # fmt: skip
    heads = [
        'rig',
        'stiffness of the shaker',
        'protection',
        'RMS [dB]',
        'largest voltage [V]',
        'said',
    ]
    return plain_markdown(heads, rows)


def figure(path: Path) -> None:
    """Spectra with and without control, beside the bounds."""
    fig, axes = plt.subplots(
        1, len(FIGURE_RIGS), figsize=(9.5, 3.8), sharey=True, layout='constrained'
    )
    for ax, rig in zip(axes, FIGURE_RIGS, strict=True):
        idle = run(rig, 'off')
        with_law = run(rig, 'feedforward')
        w = idle.window()
        bound = bounds(rig)[0]
        rest = slice(round(5.5 / idle.dt), None)
        best, leaky = optimum(idle, 0, 0.0), optimum(idle, 0, LEAK)
        through = regressors(idle.lower[rest, 0], idle.model[0], TAPS, True)[1]
        f, before = spectrum(idle.upper[w, 0], idle.dt)
        count = w.stop - w.start
        ideal, tame = (
            idle.upper[w, 0] + (through @ found.weights)[-count:] for found in (best, leaky)
        )
        for values, label, colour in (
            (ideal, 'Wiener optimum', '#009E73'),
            (tame, 'Wiener optimum with the leak', '#CC79A7'),
            (with_law.upper[w, 0], 'achieved by fxrls', '#D55E00'),
        ):
            ax.plot(
                f, decibel(spectrum(values, idle.dt)[1], before), color=colour, lw=1.3,
                label=label,
            )  # fmt: skip
        ax.plot(
            bound.frequency, bound.attenuation, color='#0072B2', lw=1.0, label='coherence bound'
        )
        ax.axhline(0.0, color='#444444', lw=0.8)
        ax.set(
            title=f'{rig}, strut 1', xlabel='frequency [Hz]', xlim=(1.0, 60.0), ylim=(-60.0, 15.0)
        )
        ax.grid(color='#dddddd')
    axes[0].set_ylabel('with over without control [dB]')
    lines, labels = axes[0].get_legend_handles_labels()
    fig.legend(lines, labels, frameon=False, fontsize=9, loc='outside lower center', ncols=4)
    fig.savefig(path, dpi=110)
    plt.close(fig)


def main() -> None:
    """Print the tables, and write them and the figure beside the page."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument('--page', type=Path, help='page with the marks of the tables')
    options = parser.parse_args()
    tables = {'table reach': reach(), 'table protection': protection()}
    for text in tables.values():
        print(text)
    if options.page is not None:
        fill(options.page, tables)
        folder = options.page.parent / 'figures'
        if not folder.is_dir():
            raise SatvibError(f'{folder}: no such folder')
        figure(folder / 'feedforward.png')


if __name__ == '__main__':
    main()
