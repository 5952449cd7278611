# SPDX-FileCopyrightText: 2026 The satvib authors
# SPDX-License-Identifier: Apache-2.0
"""Does the identified model know the phase at the disturbance, and does it know when it does not?

    ./satvib shell
    python benchmarks/model_phase.py --seeds 10

A law that cancels turns the wrong way when its model is 90 degrees out; 30 degrees leave it 60 degrees of room. Each
row identifies all struts of `clean_3dof` over IDENTIFY at 0 disturbance, as the graph does, and compares the model's
phase with the exact sampled response of the rig (hold, filter, latency, coil inside) at 10 and 20 Hz.
"""

import argparse
from dataclasses import dataclass

import numpy as np
from satvib_common.arrays import Array, Mask
from satvib_experiment.scenario.scenario import Scenario, load_scenario
from satvib_experiment.twin.closed_loop import ClosedLoop
from satvib_plant_sim.responses.one_strut import discrete_strut_model

FREQUENCIES = np.array([10.0, 20.0])
RATES = (100.0, 200.0, 500.0, 1000.0)
ORDERS = ((2, 3), (4, 5), (6, 7), (8, 9))
EXCITATIONS = ('squares', 'chirp', 'prbs')
FILTERS = {'matched': (4, 0.35), '50 Hz': (1, 0.0)}  # order, corner as a share of the rate


@dataclass(frozen=True)
class Case:
    """One way to identify."""

    rate: float
    filter: str = 'matched'
    excitation: str = 'prbs'
    poles: int = 6
    coefficients: int = 7
    delay: int = 1
    latency: float = 1e-3  # s
    hold: str = 'linear'
    time: float = 3.0  # s
    rig: str = 'clean_3dof'
    options: tuple[str, ...] = ()

    def scenario(self, seed: int) -> Scenario:
        """The first phases of an experiment."""
        order, share = FILTERS[self.filter]
        corner = share * self.rate or 50.0
        end = 1.0 + self.time
        rig = {
            'acquisition.sample_rate': self.rate, 'acquisition.filter_order': order,
            'acquisition.filter_corner': corner, 'acquisition.input_delay': self.latency,
            'acquisition.hold': self.hold,
        }  # fmt: skip
        return load_scenario(
            'clean_3dof',
            [
                f'rig={self.rig}',
                *(f'rig.{key}={value}' for key, value in rig.items()),
                f'seed={seed}',
                (
                    'phases=[{phase: CALIBRATE}, {phase: IDENTIFY, start: 1.0}, '
                    f'{{phase: STANDBY, start: {end}}}]'
                ),
                f'duration={end + 0.1}',
                'disturbance={kind: none}',
                (
                    f'identifier={{poles: {self.poles}, coefficients: {self.coefficients}, '
                    f'delay: {self.delay}}}'
                ),
                (
                    f'controller={{law: off, excitation: {self.excitation}, '
                    f'excitation_options: [{", ".join(self.options)}]}}'
                ),
                'analysis={}',
            ],
        )


def phase_errors(case: Case, seeds: range) -> tuple[Array, Mask]:
    """Absolute phase error in degrees, (seeds, struts, frequencies), and what is trusted, (seeds, struts)."""
    loop = ClosedLoop([case.scenario(seed) for seed in seeds])
    for step in loop.steps():
        found = step.identification
    model = found.model()
    errors = np.zeros((*found.converged.shape, len(FREQUENCIES)))
    for strut in range(loop.plant.struts):
        true = discrete_strut_model(loop.rigs[0], strut).response(FREQUENCIES)
        guess = model.frequency_response(FREQUENCIES)[:, strut]
        errors[:, strut] = np.degrees(np.abs(np.angle(guess / true)))
    return errors, found.converged


def row(case: Case, seeds: range) -> str:
    """One line of the table."""
    errors, trusted = phase_errors(case, seeds)
    worst = errors.max(axis=(0, 1))
    trusted_errors = np.where(trusted[..., None], errors, 0.0).max(axis=(0, 1))
    share = 100.0 * trusted.mean()
    shown = f'{trusted_errors[0]:.1f} / {trusted_errors[1]:.1f}' if trusted.any() else '-'
    return (
        f'| {case.rate:.0f} | {case.filter} | {case.excitation} | {case.poles}/{case.coefficients}, '
        f'{case.delay} | {1e3 * case.latency:g} | {worst[0]:.1f} / {worst[1]:.1f} | {share:.0f} | {shown} |'
    )


HEAD = (
    '| rate [Hz] | filter | excitation | poles/coefficients, delay | latency [ms] | '
    'phase error at 10 / 20 Hz, worst [deg] | trusted [%] | worst of the trusted [deg] |\n'
    '|---|---|---|---|---|---|---|---|'
)


def main() -> None:
    """Print the tables."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument('--seeds', type=int, default=10)
    options = parser.parse_args()
    seeds = range(1, options.seeds + 1)
    print(
        f'Orders, rates, filters and excitations; linear hold, seeds 1 to {options.seeds}\n\n{HEAD}'
    )
    for name in FILTERS:
        for rate in RATES:
            for excitation in EXCITATIONS:
                for poles, coefficients in ORDERS:
                    case = Case(rate, name, excitation, poles, coefficients)
                    print(row(case, seeds), flush=True)


if __name__ == '__main__':
    main()
