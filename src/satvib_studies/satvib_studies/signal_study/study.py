# SPDX-FileCopyrightText: 2026 The satvib authors
# SPDX-License-Identifier: Apache-2.0
"""The paper's simulation study (its Figs. 3-5): which signal identifies the model, disturbed or not.

Every signal has the same peak and the same two seconds; the plant is the paper's printed G(z). Noise is white on the
output, the disturbance a tone on the output with a phase of its own for each seed. All seeds of a case run at once
through the very `IdentifierCore` of the node.
"""

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from satvib_common.arrays import Array
from satvib_common.errors import SatvibError
from satvib_common.levels import rms_with_mean
from satvib_common.phases import Phase
from satvib_common.schema import Schema, param
from satvib_experiment.scenario.memory import check_needs
from satvib_ident.excitation.factory import make_excitation
from satvib_ident.excitation.signal import Excitation
from satvib_ident.identifier import IdentifierCore
from satvib_ident.models.iir_model import IirModel
from satvib_ident.parameters import ESTIMATORS, IdentifierParameters

# the paper's text speaks of two sinusoids and of five signals; its experiment uses two squares
STUDIED: dict[str, tuple[str, dict[str, object]]] = {
    '1 sine': ('sines', {'frequencies': [1.0]}),
    '2 sines': ('sines', {'frequencies': [1.0, 2.0]}),
    '5 sines': ('sines', {'frequencies': [1.0, 2.0, 3.0, 4.0, 5.0]}),
    '2 squares': ('squares', {'frequencies': [1.0, 2.0]}),
    'chirp': ('chirp', {}),
    'random': ('random', {'low': 1.0, 'high': 40.0}),
    'multisine': ('multisine', {'low': 1.0, 'high': 40.0, 'struts': 1}),
    'PRBS': ('prbs', {'clock': 1}),
}
CASES = ('clean', 'noise', 'disturbance', 'both')
_STEP_TIME = 20e-6  # s of a processor for a sample of a case, at least
NAMES = ('a1', 'a2', 'b1', 'b2', 'b3')


@dataclass(frozen=True, kw_only=True)
class StudySettings(Schema):
    """What the study varies and what it holds."""

    sample_rate: float = param(100.0, 'sample rate', unit='Hz', above=0.0)
    duration: float = param(2.0, 'time of identification', unit='s', above=0.1)
    amplitude: float = param(1.0, 'peak of every signal', unit='V', above=0.0)
    noise: float = param(
        0.0025,
        'deviation of the noise on the output, in the units of the printed G(z)',
        minimum=0.0,
    )
    disturbance: float = param(0.005, 'amplitude of the tone on the output, likewise', minimum=0.0)
    frequency: float = param(10.0, 'its frequency', unit='Hz', above=0.0)
    seeds: int = param(100, 'runs of each case', minimum=1, maximum=100000)
    seed: int = param(1, 'seed of noise and phases', minimum=0)
    estimator: str = param('least_squares', 'as in the identifier', choices=ESTIMATORS)
    signals: tuple[str, ...] = param(tuple(STUDIED), 'which signals', choices=tuple(STUDIED))

    def check(self) -> None:
        """Refuse what does not fit into this machine."""
        samples = self.duration * self.sample_rate
        check_needs(
            f'seeds, duration: {self.seeds} runs of {samples:.6g} samples',
            8.0 * samples * self.seeds,
            samples * len(self.signals) * len(CASES) * _STEP_TIME,
        )


@dataclass(frozen=True, eq=False)
class StudyRow:
    """One signal in one case, over all seeds.

    Attributes:
        signal: its name in STUDIED.
        case: clean, noise, disturbance or both.
        bias: (5) mean error of a1 a2 b1 b2 b3.
        rms: (5) root mean square error of each.
        response: root mean square over seeds of the largest relative error of the response in the trust band.
        order: order of persistent excitation.
        condition: median condition of the normalized information.
        trusted: share of the runs whose model the identifier would let through.
        worst_trusted: largest relative error of the response among those; NaN without any.
        trace: (samples, 5) estimates of the first seed over time, for the figures.
    """

    signal: str
    case: str
    bias: Array
    rms: Array
    response: float
    order: int
    condition: float
    trusted: float
    worst_trusted: float
    trace: Array

    def to_mapping(self) -> dict[str, object]:
        """Plain data, for result.json."""
        return {
            'signal': self.signal,
            'case': self.case,
            'bias': dict(zip(NAMES, self.bias.tolist(), strict=True)),
            'rms': dict(zip(NAMES, self.rms.tolist(), strict=True)),
            'response': self.response,
            'order': self.order,
            'condition': self.condition,
            'trusted': self.trusted,
            'worst_trusted': self.worst_trusted if self.trusted > 0.0 else None,
        }


@dataclass(frozen=True, eq=False)
class StudyResult:
    """All rows, signal by signal, with what made them.

    Attributes:
        settings: as given.
        plant: the model that is to be found.
        rows: one per signal and case.
    """

    settings: StudySettings
    plant: IirModel
    rows: tuple[StudyRow, ...]

    def row(self, signal: str, case: str) -> StudyRow:
        """Find one row."""
        for row in self.rows:
            if (row.signal, row.case) == (signal, case):
                return row
        raise SatvibError(f'study: {signal!r} in case {case!r} was not run')

    HEADINGS = ('signal', 'case', *(f'rms {name}' for name in NAMES), 'bias a1', 'response', 'order',
                'condition', 'trusted', 'worst trusted')  # fmt: skip

    def table(self) -> list[tuple[str, ...]]:
        """The rows as text under HEADINGS."""
        return [
            (
                row.signal,
                row.case,
                *(f'{value:.4f}' if value < 1e3 else '> 1000' for value in row.rms),
                f'{row.bias[0]:+.4f}' if abs(row.bias[0]) < 1e3 else '-',
                f'{100.0 * row.response:.1f} %' if row.response < 10.0 else '> 1000 %',
                str(row.order),
                f'{row.condition:.1e}',
                f'{100.0 * row.trusted:.0f} %',
                f'{100.0 * row.worst_trusted:.1f} %' if row.trusted > 0.0 else '-',
            )
            for row in self.rows
        ]


def paper_plant(dt: float) -> IirModel:
    """The paper's printed G(z), whose output is in g per V."""
    return IirModel([-0.460, 0.158], [0.061, -0.103, 0.033], 0, dt)


def make_signal(name: str, settings: StudySettings) -> Excitation:
    """Make a signal of STUDIED with the study's peak and rate."""
    kind, options = STUDIED[name]
    dt = 1.0 / settings.sample_rate
    return make_excitation(kind, amplitude=settings.amplitude, dt=dt, seed=settings.seed, **options)


def _run_case(settings: StudySettings, plant: IirModel, name: str, case: str) -> StudyRow:
    count = round(settings.duration * settings.sample_rate)
    parameters = IdentifierParameters(
        sample_rate=settings.sample_rate, delay=0, bias='none', estimator=settings.estimator,
        measure_period=count, initial_covariance=1e6 if 'normal' in settings.estimator else 1e18,
    )  # fmt: skip
    core = IdentifierCore(parameters, (settings.seeds,))
    u = make_signal(name, settings).samples(count)
    clean = plant.simulate(u)
    generator = np.random.default_rng([settings.seed, CASES.index(case)])
    phase = generator.uniform(0.0, 2.0 * np.pi, settings.seeds)
    white = generator.normal(size=(count, settings.seeds))
    noise = settings.noise if case in {'noise', 'both'} else 0.0
    tone = settings.disturbance if case in {'disturbance', 'both'} else 0.0
    turn = 2.0 * np.pi * settings.frequency / settings.sample_rate
    trace = np.empty((count, plant.theta.size))
    for k in range(count):
        y = clean[k] + tone * np.sin(turn * k + phase) + noise * white[k]
        found = core.step(k, Phase.IDENTIFY, y, np.full(settings.seeds, u[k]))
        trace[k] = core.estimator.theta[0, : plant.theta.size]
    model = found.model()
    error = model.theta - plant.theta
    low, high = parameters.trust_band
    f = np.geomspace(low, high, 8)
    true = plant.frequency_response(f)
    with np.errstate(all='ignore'):
        response = np.max(np.abs(model.frequency_response(f) / true - 1.0), axis=-1)
    return StudyRow(
        signal=name,
        case=case,
        bias=np.mean(error, axis=0),
        rms=rms_with_mean(error),
        response=float(rms_with_mean(response)),
        order=int(found.excitation_order[0]),
        condition=float(np.median(found.information_condition)),
        trusted=float(np.mean(found.converged)),
        worst_trusted=float(np.max(response[found.converged]))
        if found.converged.any()
        else float('nan'),
        trace=trace,
    )


def run(
    settings: StudySettings | None = None, progress: Callable[[str], None] | None = None
) -> StudyResult:
    """Run every signal in every case.

    Args:
        settings: as wanted; the paper's by default.
        progress: called with the signal and the case before each run.
    """
    chosen = settings or StudySettings()
    plant = paper_plant(1.0 / chosen.sample_rate)
    rows = []
    for name in chosen.signals:
        for case in CASES:
            if progress is not None:
                progress(f'{name}, {case}')
            rows.append(_run_case(chosen, plant, name, case))
    return StudyResult(chosen, plant, tuple(rows))
