# SPDX-FileCopyrightText: 2026 The satvib authors
# SPDX-License-Identifier: Apache-2.0
"""The tables of docs/identification.md.

    python benchmarks/identification_tables.py bias
    python benchmarks/identification_tables.py survival [--minutes 60]    # ten minutes of computing
    python benchmarks/identification_tables.py trust [--trials 10]
    python benchmarks/identification_tables.py study [--figures FOLDER]

All seeds are fixed, so the figures come out again.
"""

import argparse
import sys
from pathlib import Path

ROOT = Path(__file__).resolve().parent.parent
sys.path[:0] = [str(ROOT / 'src' / f'satvib_{p}') for p in ('common', 'ident', 'plant_sim')]

import numpy as np  # noqa: E402
from satvib_common.phases import Phase  # noqa: E402
from satvib_ident.estimators.extended import ExtendedLeastSquares  # noqa: E402
from satvib_ident.estimators.instrumental import InstrumentalVariable  # noqa: E402
from satvib_ident.estimators.least_squares import RecursiveLeastSquares  # noqa: E402
from satvib_ident.estimators.regressor import IirRegressor  # noqa: E402
from satvib_ident.excitation import make_excitation  # noqa: E402
from satvib_ident.identifier import Identification, IdentifierCore  # noqa: E402
from satvib_ident.models.iir_model import IirModel  # noqa: E402
from satvib_ident.parameters import FORGETTING, IdentifierParameters  # noqa: E402
from satvib_studies.signal_study.study import StudySettings, run  # noqa: E402

A, B = [-0.460, 0.158], [0.061, -0.103, 0.033]
BAND = np.geomspace(5.0, 20.0, 8)


def row(*cells: str) -> None:
    """One line of a Markdown table."""
    print('| ' + ' | '.join(cells) + ' |')


def heading(*cells: str) -> None:
    """The first two lines of a Markdown table."""
    row(*cells)
    row(*['---'] * len(cells))


def bias() -> None:
    """Error of a1 from noise of 0.005 on the output of the paper's G(z), PRBS of +-1 V, 200 seeds."""
    plant, trials = IirModel(A, B, 0, 0.01), 200
    heading('estimator', 'samples', 'bias of a1', 'RMS error', 'predicted deviation', 'bias of a2')
    for samples in (200, 500, 2000):
        u = np.array(
            [
                make_excitation('prbs', amplitude=1.0, dt=0.01, seed=s).samples(samples)
                for s in range(trials)
            ]
        )
        y = plant.simulate(u) + 0.005 * np.random.default_rng([26, 1]).normal(size=u.shape)
        for name, estimator in (
            ('least squares', RecursiveLeastSquares(5, (trials,))),
            ('extended', ExtendedLeastSquares(5, 2, (trials,))),
            ('instrumental', InstrumentalVariable(2, 3, 2, (trials,))),
        ):
            regressor = IirRegressor(2, 3, 0, (trials,))
            for k in range(samples):
                estimator.update(*regressor.step(y[:, k], u[:, k], 0.0))
            error = estimator.theta[:, :2] - plant.a
            rms = np.sqrt(np.mean(error[:, 0] ** 2))
            sigma = np.mean(np.sqrt(estimator.covariance[:, 0, 0]))
            row(name, str(samples), f'{error[:, 0].mean():+.4f}', f'{rms:.4f}', f'{sigma:.4f}',
                f'{error[:, 1].mean():+.4f}')  # fmt: skip


def life(
    rule: str, noise: float, minutes: float, seeds: int, **options: object
) -> tuple[float, float, np.ndarray]:
    """1 s of rest, 4 s of PRBS of 5 V, silence, then a changed plant and 2 s more.

    Returns:
        Furthest that a1 moves in the silence, largest trace of P in it, share by which a1 is off at the end (seeds).
    """
    plant, changed = IirModel(A, B, 1, 0.01), IirModel([-0.70, 0.25], [0.05, -0.09, 0.03], 1, 0.01)
    until = 500 + round(minutes * 6000)
    signal = make_excitation('prbs', amplitude=5.0, dt=0.01)
    u = np.concatenate([np.zeros(100), signal.samples(400), np.zeros(until - 500),
                        signal.samples(900)[700:]])  # fmt: skip
    clean = np.concatenate([plant.simulate(u[:until]), changed.simulate(u[until:])])
    parameters = IdentifierParameters.from_mapping(
        {'forgetting': rule, 'dead_zone': 0.015, 'measure_period': 10**9} | options, 'survival'
    )
    core, out = IdentifierCore(parameters, (seeds,)), None
    generator = np.random.default_rng([41])
    trace, stop, moved = 0.0, np.zeros(seeds), np.zeros(seeds)
    for k in range(len(u)):
        phase = Phase.CALIBRATE if k < 100 else Phase.IDENTIFY
        y = clean[k] + noise * generator.normal(size=seeds)
        out = core.step(k, phase, y, np.full(seeds, u[k - 1] if k else 0.0))
        if k == 500:
            stop = out.a[:, 0]
        if 500 < k < until and k % 500 == 499:
            P = core.estimator.P
            np.linalg.cholesky(P)
            trace = max(trace, float(np.trace(P, axis1=-2, axis2=-1).max()))
            moved = np.maximum(moved, np.abs(out.a[:, 0] - stop))
    assert isinstance(out, Identification)
    return float(moved.max()), trace, np.abs(out.a[:, 0] / changed.a[0] - 1.0)


def survival(minutes: float) -> None:
    """An hour of silence with the gates of the identifier, without that on the voltage, and without both; 20 seeds."""
    heading('rule', 'no noise', 'noise 0.005', 'no gate on the voltage', 'no gate at all',
            'largest trace of P', 'a1 off after the change')  # fmt: skip
    for rule in FORGETTING:
        silent, _, _ = life(rule, 0.0, minutes, 20)
        moved, trace, off = life(rule, 0.005, minutes, 20)
        open_, _, _ = life(rule, 0.005, minutes, 20, input_hold=1e9)
        bare, _, _ = life(rule, 0.005, minutes, 20, input_hold=1e9, bias='none')
        row(rule, f'{silent:.4f}', f'{moved:.4f}', f'{open_:.4f}', f'{bare:.4f}', f'{trace:.3g}',
            f'{100 * off.mean():.1f} % (to {100 * off.max():.1f} %)')  # fmt: skip
        sys.stdout.flush()


def response(rig: object, strut: int, amplitude: float) -> np.ndarray:
    """True response of a strut in BAND: 20 s of multisine on it alone, by the ratio of spectra, 6 trials averaged."""
    from satvib_plant_sim.disturbance import make_disturbance
    from satvib_plant_sim.plant.plant import Plant

    rate = rig.acquisition.sample_rate
    plant = Plant([rig] * 6, make_disturbance({'kind': 'none'}), list(range(6)))
    signal = make_excitation('multisine', amplitude=amplitude, dt=1 / rate, struts=1, low=2.0,
                             high=0.3 * rate, period=2.0)  # fmt: skip
    period = signal.count
    sums = np.zeros((2, period, 6))
    for k in range(11 * period):
        y, u = plant.sample().upper[:, strut], np.zeros((6, plant.struts))
        u[:, strut] = signal.at(k)
        plant.advance(u)
        if k >= period:
            sums[0, k % period] += y
            sums[1, k % period] += u[:, strut]
    spectra = np.fft.rfft(sums, axis=1)
    lines = signal.own_lines
    ratio = (spectra[0, lines] / spectra[1, lines]).mean(axis=-1)
    f = lines / (period / rate)
    return np.interp(BAND, f, ratio.real) + 1j * np.interp(BAND, f, ratio.imag)


def trust(trials: int) -> None:
    """What the verdict says and what is true, on the rigs: 1 s at rest, 2 s of excitation of all struts at once."""
    from satvib_plant_sim.disturbance import make_disturbance
    from satvib_plant_sim.plant.plant import Plant
    from satvib_plant_sim.rig.rig import load_rig

    heading('rig', 'n/m', 'signal', 'peak [V]', 'estimator', 'largest error, true',
            'as the residual tells', 'as the covariance tells', 'trusted')  # fmt: skip
    cases = [
        ('paper_3dof', 2, 3, volts, signal)
        for volts in (1.0, 3.0, 10.0)
        for signal in ('squares', 'multisine')
    ]
    cases += [
        ('clean_3dof', n, m, 10.0, s) for n, m in ((2, 3), (4, 5)) for s in ('squares', 'chirp')
    ]
    cases += [
        ('soft_3dof', n, m, 2.0, s) for n, m in ((2, 3), (4, 5)) for s in ('squares', 'chirp')
    ]
    truths: dict[str, np.ndarray] = {}
    for name, n, m, volts, kind in cases:
        rig = load_rig(name)
        rate = rig.acquisition.sample_rate
        if name not in truths:
            level = 2.0 if name == 'soft_3dof' else 10.0
            truths[name] = np.array([response(rig, s, level) for s in range(3)])
        for estimator in ('least_squares', 'instrumental'):
            plant = Plant([rig] * trials, make_disturbance({'kind': 'none'}), list(range(trials)))
            parameters = IdentifierParameters(
                sample_rate=rate, poles=n, coefficients=m, estimator=estimator
            )
            core = IdentifierCore(parameters, (trials, 3))
            signals = [
                make_excitation(kind, amplitude=volts, dt=1 / rate, strut=s) for s in range(3)
            ]
            begin, end, before, out = round(rate), round(3 * rate), np.zeros((trials, 3)), None
            for k in range(end):
                phase = Phase.CALIBRATE if k < begin else Phase.IDENTIFY
                out = core.step(k, phase, plant.sample().upper, before)
                before = np.zeros((trials, 3)) + [
                    s.at(k - begin) if k >= begin else 0.0 for s in signals
                ]
                plant.advance(before)
            assert isinstance(out, Identification)
            found = out.model().frequency_response(BAND)
            true = np.abs(truths[name] / found - 1.0).max(axis=-1)
            row(name, f'{n}/{m}', kind, f'{volts:g}', estimator.replace('_', ' '),
                f'{np.median(true):.2f} (to {true.max():.2f})',
                f'{np.median(out.model_error):.2f} (to {out.model_error.max():.2f})',
                f'{np.median(out.response_deviation):.2f}',
                f'{100 * np.mean(out.converged):.0f} %')  # fmt: skip


def study(figures: Path | None) -> None:
    """The simulation study, both ways of estimating."""
    for estimator in ('least_squares', 'instrumental'):
        result = run(StudySettings(estimator=estimator))
        print(f'\n{estimator}, {result.settings.seeds} seeds\n')
        heading(*result.HEADINGS)
        for cells in result.table():
            row(*cells)
        if figures is not None:
            from satvib_studies.signal_study.plots import save_figures

            save_figures(result, figures / estimator)


def main() -> None:
    """Print the table asked for."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument('table', choices=('bias', 'survival', 'trust', 'study'))
    parser.add_argument('--minutes', type=float, default=60.0, help='of silence')
    parser.add_argument('--trials', type=int, default=10)
    parser.add_argument('--figures', type=Path)
    options = parser.parse_args()
    match options.table:
        case 'bias':
            bias()
        case 'survival':
            survival(options.minutes)
        case 'trust':
            trust(options.trials)
        case 'study':
            study(options.figures)


if __name__ == '__main__':
    main()
