# SPDX-FileCopyrightText: 2026 The satvib authors
# SPDX-License-Identifier: Apache-2.0
"""Do the laws stay stable when the rig is not what the model says?

    ./satvib shell
    python benchmarks/robustness.py --trials 2000 --laws velocity_feedback model_reference

Each trial draws a rig: payload mass and stiffness +-30 %, force constant +-10 %, resistance +-12.5 %, inductance
+-30 %, input delay +-1 ms (not below 0), own noise and bias. Two cases: `own` identifies the drawn rig, as the graph
does; `nominal` hands every trial the model of the nominal rig, whatever it is in truth. A trial is unstable when its
true RMS in the last 2 s of control is above 1.5 times that without control, when a fault is latched, or when the
watch had to step in.
Attenuation is true RMS (fine grid) with control over without, worst strut of a trial.
"""

import argparse
import time

import numpy as np
from numpy.typing import NDArray
from satvib_bringup.closed_loop import ClosedLoop
from satvib_bringup.scenario import Scenario, load_scenario
from satvib_common.phases import Phase
from satvib_ident.iir_model import IirModel
from satvib_plant_sim.rig import Rig, load_rig

PHASES = (
    'phases=[{phase: CALIBRATE, start: 0.0}, {phase: IDENTIFY, start: 0.5}, {phase: ADAPT, start: 2.5},'
    ' {phase: STANDBY, start: 4.5}, {phase: CONTROL, start: 6.5}]'
)
RIGS = {
    'paper_3dof': (),
    'clean_3dof': ('identifier.poles=4', 'identifier.coefficients=5', 'controller.excitation=squares'),
    'soft_3dof': (
        'identifier.poles=8', 'identifier.coefficients=8', 'controller.excitation=prbs',
        'controller.excitation_amplitude=2.0', 'controller.reference_voltage=1.0',
    ),
}  # fmt: skip
END = 12.5


def scenario_of(rig: str, law: str, seed: int) -> Scenario:
    """A short form of the rig's scenario."""
    changes = [
        *RIGS[rig],
        PHASES,
        f'duration={END}',
        f'seed={seed}',
        f'controller.law={law}',
        'disturbance={kind: sine, frequency: 10.0, amplitude: 0.5, start: 4.5}',
        'analysis.uncontrolled=[5.5, 6.5]',
        f'analysis.controlled=[10.5, {END}]',
    ]
    if law.startswith('velocity_feedback'):
        changes.append('controller.velocity_gain=2000.0')
    return load_scenario(rig, changes)


def drawn_rig(name: str, trial: int) -> Rig:
    """The nominal rig for trial 0, a drawn one for any other."""
    nominal = load_rig(name)
    if trial == 0:
        return nominal
    rng = np.random.default_rng([7, trial])

    def about(value: float, share: float) -> float:
        return value * (1.0 + share * (2.0 * float(rng.random()) - 1.0))

    return load_rig(
        name,
        {
            'payload.mass': about(nominal.payload.mass, 0.3),
            'struts.stiffness': about(nominal.struts.stiffness, 0.3),
            'coil.force_constant': about(nominal.coil.force_constant, 0.1),
            'coil.resistance': about(nominal.coil.resistance, 0.125),
            'coil.inductance': about(nominal.coil.inductance, 0.3),
            'acquisition.input_delay': max(
                nominal.acquisition.input_delay + 1e-3 * (2.0 * float(rng.random()) - 1.0), 0.0
            ),
        },
    )


def nominal_model(rig: str, law: str) -> tuple[IirModel, NDArray]:
    """The model that the nominal rig's identification ends with, per strut, and its covariance."""
    loop = ClosedLoop([scenario_of(rig, law, 1)], [load_rig(rig)])
    for step in loop.steps():
        if step.phase == Phase.ADAPT:
            break
    found = step.identification
    if not np.all(found.converged):
        raise SystemExit(f'{rig}: the nominal model is not trusted: {found.reasons}')
    return found.model(), found.covariance


def hand_over_always(loop: ClosedLoop, model: IirModel, covariance: NDArray) -> None:
    """Whatever the loop hands over, its controller gets this model."""
    take = loop.controller.set_model
    loop.controller.set_model = lambda *_: take(model, True, '', covariance)


def run(rig: str, law: str, case: str, trials: int) -> tuple[NDArray, NDArray, NDArray, NDArray]:
    """Attenuation (trials) in dB, and bool (trials): unstable, stepped in by the watch, trusted on every strut."""
    scenarios = [scenario_of(rig, law, seed) for seed in range(trials)]
    loop = ClosedLoop(scenarios, [drawn_rig(rig, trial) for trial in range(trials)])
    if case == 'nominal':
        hand_over_always(loop, *nominal_model(rig, law))
    shape = (trials, loop.plant.struts)
    dt = loop.plant.dt
    power = np.zeros((2, *shape))
    windows = ((5.5, 6.5), (10.5, END))
    watched = np.zeros(shape, dtype=bool)
    for step in loop.steps():
        time_now = step.sequence * dt
        for i, (begin, end) in enumerate(windows):
            if begin <= time_now < end:
                power[i] += (step.truth.upper**2).mean(axis=-1) / round((end - begin) / dt)
        watched |= loop.controller.watch.reduced()
    gain = 10.0 * np.log10(power[1] / power[0]).max(axis=-1)
    fault = step.output.fault.any(axis=-1)
    unstable = (gain > 20.0 * np.log10(1.5)) | fault | watched.any(axis=-1) | ~np.isfinite(gain)
    trusted = np.isfinite(step.output.state.ki_max).all(axis=-1)
    return gain, unstable, watched.any(axis=-1), trusted


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument('--trials', type=int, default=200)
    parser.add_argument('--rigs', nargs='+', default=list(RIGS), choices=list(RIGS))
    parser.add_argument('--laws', nargs='+', default=['velocity_feedback', 'model_reference'])
    parser.add_argument('--cases', nargs='+', default=['own', 'nominal'])
    options = parser.parse_args()
    print(
        '| rig | law | model | trials | unstable | watch | median [dB] | 95 % below [dB] | worst [dB] | s |'
    )
    print('|---|---|---|---|---|---|---|---|---|---|')
    for rig in options.rigs:
        for law in options.laws:
            for case in options.cases:
                start = time.perf_counter()
                gain, unstable, watched, _ = run(rig, law, case, options.trials)
                print(
                    f'| {rig} | {law} | {case} | {options.trials} | {unstable.sum()} | {watched.sum()} | '
                    f'{np.median(gain):.1f} | {np.percentile(gain, 95):.1f} | {gain.max():.1f} | '
                    f'{time.perf_counter() - start:.0f} |',
                    flush=True,
                )


if __name__ == '__main__':
    main()
