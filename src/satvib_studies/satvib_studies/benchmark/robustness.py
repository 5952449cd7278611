# SPDX-FileCopyrightText: 2026 The satvib authors
# SPDX-License-Identifier: Apache-2.0
"""Do the laws stay stable when the rig is not what the model says?

`benchmarks/robustness.py` prints the table.

Each trial draws a rig: payload mass and stiffness +-30 %, force constant +-10 %, resistance +-12.5 %, inductance
+-30 %, input delay +-1 ms (not below 0), own noise and bias; the disturbance is 10 Hz. Two cases: `own` identifies the
drawn rig, as the graph does; `nominal` hands every trial the model of the nominal rig, whatever that trial's rig is.

A trial is *unstable* when a fault is latched, or when the vibration that the loop sees in the last 2 s is above 1.5
times that without control. *Backed off*: the watch, or the law itself, took the voltage back at least once. Attenuation
is true RMS (fine grid) with control over without, of a trial the worst strut; *worse*: above +0.5 dB of that.
"""

from collections.abc import Iterator
from dataclasses import dataclass, fields

import numpy as np
from satvib_common.arrays import Array, Mask
from satvib_common.errors import SatvibError
from satvib_common.phases import Phase
from satvib_control.laws.feedforward import law as feedforward
from satvib_control.laws.narrowband import law as narrowband
from satvib_experiment.scenario.scenario import Scenario, load_scenario
from satvib_experiment.twin.closed_loop import ClosedLoop
from satvib_ident.models.iir_model import IirModel
from satvib_plant_sim.rig.random_rig import random_payload
from satvib_plant_sim.rig.rig import Rig, load_rig

PHASES = (
    'phases=[{phase: CALIBRATE, start: 0.0}, {phase: IDENTIFY, start: 0.5}, {phase: ADAPT, start: 2.5},'
    ' {phase: STANDBY, start: 4.5}, {phase: CONTROL, start: 6.5}]'
)
RIGS = {
    'paper_3dof': ('identifier.poles=4', 'identifier.coefficients=5', 'controller.excitation=chirp'),
    'clean_3dof': ('identifier.poles=6', 'identifier.coefficients=7', 'controller.excitation=chirp'),
    'soft_3dof': (
        'identifier.poles=6', 'identifier.coefficients=7', 'controller.excitation=squares',
        'controller.excitation_amplitude=2.0', 'controller.reference_voltage=1.0',
    ),
}  # fmt: skip
LAWS = (
    'velocity_feedback', 'model_reference', 'feedforward', 'velocity_feedback+feedforward', 'narrowband',
)  # fmt: skip
END = 16.5
BATCH = 500
RETREATS = np.array([feedforward.BACKED_OFF, feedforward.GAVE_UP, narrowband.HELD])


def scenario_of(rig: str, law: str, seed: int, end: float = END) -> Scenario:
    """A short form of the rig's scenario, which ends after `end` seconds."""
    changes = [
        *RIGS[rig],
        PHASES,
        f'duration={end}',
        f'seed={seed}',
        f'controller.law={law}',
        'disturbance={kind: sine, frequency: 10.0, amplitude: 0.5, start: 4.5}',
        'analysis.uncontrolled=[5.5, 6.5]',
        f'analysis.controlled=[{end - 6.0}, {end}]',
    ]
    if law.startswith('velocity_feedback'):
        changes.append('controller.velocity_gain=2000.0')
    return load_scenario(rig, changes)


def drawn_rig(name: str, trial: int) -> Rig:
    """The nominal rig for trial 0, a drawn one for any other."""
    nominal = load_rig(name)
    return nominal if trial == 0 else random_payload(nominal, np.random.default_rng([7, trial]))


def nominal_model(rig: str, law: str) -> tuple[IirModel, Array]:
    """The model that the nominal rig's identification ends with, per strut, and its covariance."""
    loop = ClosedLoop([scenario_of(rig, law, 1)], [load_rig(rig)])
    for step in loop.steps():
        if step.phase == Phase.ADAPT:
            break
    found = step.identification
    if not np.all(found.converged):
        raise SatvibError(f'{rig}: the nominal model is not trusted: {found.reasons}')
    return found.model(), found.covariance


def hand_over_always(loop: ClosedLoop, model: IirModel, covariance: Array) -> None:
    """Whatever the loop hands over, its controller gets this model."""
    take = loop.controller.set_model
    always = np.asarray(True)
    loop.controller.set_model = lambda *_: take(model, always, '', covariance)  # type: ignore[method-assign]


@dataclass(frozen=True)
class TrialResults:
    """Results of trials, each (trials,)."""

    gain: Array  # dB, true RMS, worst strut
    unstable: Mask
    backed_off: Mask
    trusted: Mask

    def row(self) -> str:
        """Trials and shares for the table."""
        low, middle, high = np.percentile(self.gain, [5, 50, 95])
        return (
            f'{len(self.gain)} | {self.unstable.sum()} | {self.backed_off.sum()} | '
            f'{(self.gain > 0.5).sum()} | {low:.1f} | {middle:.1f} | {high:.1f} | {self.gain.max():.1f}'
        )


def run(
    rig: str, law: str, case: str, trials: int, first: int = 0, end: float = END
) -> TrialResults:
    """Run trials `first` and following of one rig, law and case."""
    numbers = range(first, first + trials)
    scenarios = [scenario_of(rig, law, seed, end) for seed in numbers]
    loop = ClosedLoop(scenarios, [drawn_rig(rig, trial) for trial in numbers])
    if case == 'nominal':
        hand_over_always(loop, *nominal_model(rig, law))
    shape = (trials, loop.plant.struts)
    dt = loop.plant.dt
    true, seen = np.zeros((2, *shape)), np.zeros((2, *shape))
    windows = ((5.5, 6.5), (end - 2.0, end))
    backed = np.zeros(shape, dtype=bool)
    trusted = np.zeros(shape, dtype=bool)
    for step in loop.steps():
        now = step.sequence * dt
        for i, (begin, end) in enumerate(windows):
            if begin <= now < end:
                count = round((end - begin) / dt)
                true[i] += (step.truth.upper**2).mean(axis=-1) / count
                seen[i] += (step.sample.upper - step.output.bias_upper) ** 2 / count
        backed |= loop.controller.watch.reduced() | np.isin(step.output.reason, RETREATS)
        trusted = step.identification.converged | (case == 'nominal')
    gain = 10.0 * np.log10(true[1] / true[0]).max(axis=-1)
    loud = (seen[1] > 2.25 * seen[0]).any(axis=-1)
    unstable = loud | step.output.fault.any(axis=-1) | ~np.isfinite(gain)
    return TrialResults(
        gain, unstable, np.asarray(backed.any(axis=-1)), np.asarray(trusted.all(axis=-1))
    )


def table(
    rigs: list[str], laws: list[str], cases: list[str], numbers: range, end: float
) -> Iterator[str]:
    """The lines of the table, batch by batch so that memory stays bounded."""
    yield (
        '| rig | law | model | trials | unstable | backed off | worse | 5 % below [dB] | median [dB] | '
        '95 % below [dB] | worst [dB] |'
    )
    yield '|---|---|---|---:|---:|---:|---:|---:|---:|---:|---:|'
    for rig in rigs:
        for law in laws:
            for case in cases:
                parts = [
                    run(rig, law, case, len(numbers[at : at + BATCH]), numbers[at], end)
                    for at in range(0, len(numbers), BATCH)
                ]
                whole = TrialResults(
                    *(
                        np.concatenate([getattr(part, field.name) for part in parts])
                        for field in fields(TrialResults)
                    )
                )
                yield f'| {rig} | {law} | {case} | {whole.row()} |'
