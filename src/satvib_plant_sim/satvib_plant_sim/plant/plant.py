# SPDX-FileCopyrightText: 2026 The satvib authors
# SPDX-License-Identifier: Apache-2.0
"""The plant: what the board reads and what a voltage does, for one rig or for thousands.

plant = Plant(load_rig('paper_3dof'), make_disturbance({...}), seed=1)
sample = plant.sample()              # .sequence, .upper, .lower
truth = plant.advance(voltage)       # noise-free, between this sample and the next
"""

from collections.abc import Mapping, Sequence
from functools import partial

import numpy as np
from numpy.typing import ArrayLike
from satvib_common.arrays import Array

from satvib_plant_sim.disturbance import Disturbance
from satvib_plant_sim.disturbance.mixer import Mixer
from satvib_plant_sim.physics.converters import (
    advance_noise,
    drawn_bias,
    drive_output,
    input_settings,
    output_settings,
    read_input,
    sensor_scale,
)
from satvib_plant_sim.physics.energy import stored_energy
from satvib_plant_sim.physics.modes import equilibrium
from satvib_plant_sim.physics.noise import NormalSource, noise_model
from satvib_plant_sim.plant.batch import agree, checked_voltage, trials_of
from satvib_plant_sim.plant.observation import Sample, Truth
from satvib_plant_sim.responses.continuous import source_transfer
from satvib_plant_sim.rig.rig import Rig
from satvib_plant_sim.stepping.discretize import Discrete, discretize
from satvib_plant_sim.stepping.period import advance_period

__all__ = ['Plant', 'Sample', 'Truth']

CONSTANTS = (
    'step', 'push', 'chain', 'hold', 'force', 'strut', 'inertia', 'point', 'shaker', 'stop', 'theta',
)  # fmt: skip


class Plant:
    """Simulated rigs, sample by sample.

    Args:
        rig, disturbance, seed: one each for a plant of shape (); sequences of equal length for a batch of trials, of
            which single ones are shared. All rigs of a batch agree in struts, sample rate, fine steps and the order
            of the anti-alias filter.

    A trial holds 30 to 55 kB, with random disturbances up to 50 kB more, however long it runs.

    Raises:
        SatvibError: lengths or rigs that do not agree, a seed below 0.
    """

    def __init__(
        self,
        rig: Rig | Sequence[Rig],
        disturbance: Disturbance | Sequence[Disturbance],
        seed: int | Sequence[int],
    ) -> None:
        rigs, disturbances, seeds, self.shape = trials_of(rig, disturbance, seed)
        self.rigs = tuple(rigs)
        first = rigs[0]
        designs = [discretize(r) for r in rigs]
        agree(rigs)
        self._disturbances, self._seeds = list(disturbances), seeds
        self._first_rigs = self.rigs
        self.struts = first.struts.count
        self.dt = first.acquisition.period
        self.n_fine = first.acquisition.fine_steps
        self.fine_period = self.dt / self.n_fine
        self.sequence = 0

        trials, n = len(rigs), self.struts
        self._mixer = self._mix(rigs)
        self._constants = [_stack(designs, name) for name in CONSTANTS]
        self._linear = np.array([float(r.acquisition.hold == 'linear') for r in rigs])
        delays = np.array([d.delay for d in designs])
        self._periods_late = np.array(
            [_whole_periods(r, d.delay) for r, d in zip(rigs, designs, strict=True)]
        )
        self._event = np.repeat(delays[:, None, 1:].astype(float), n, axis=1)
        self._queue = np.zeros((int(self._periods_late.max()) + 1, trials, n))

        self._state = np.zeros((trials, designs[0].force.shape[1]))
        self._ramp = np.zeros((trials, n, 4))
        self._ramp[:, :, 2] = -2.0 * self.n_fine
        self._input = np.array([input_settings(r) for r in rigs])
        self._output = np.array([output_settings(r) for r in rigs])
        self._scale = np.array([sensor_scale(r) for r in rigs])
        self._bias = np.array([drawn_bias(r, s) for r, s in zip(rigs, seeds, strict=True)])
        models = [noise_model(r) for r in rigs]
        self._E, self._L = np.stack([m[0] for m in models]), np.stack([m[1] for m in models])
        self._stages = self._E.shape[-1]
        self._normal = NormalSource(seeds, 1, 2 * n * self._stages)
        self._noise = np.zeros((trials, 2 * n, self._stages))
        start = np.stack([m[2] for m in models])
        advance_noise(np.zeros_like(start), start, self._normals(0), self._noise)
        self.terminal_voltage = np.zeros((*self.shape, n))

    def _mix(self, rigs: Sequence[Rig]) -> Mixer:
        """Put the disturbances together; amplitudes are at the lower plates of these rigs."""
        transfers = [partial(source_transfer, r) for r in rigs]
        return Mixer(self._disturbances, self._seeds, transfers, self.fine_period, self.n_fine)

    def change(self, rigs: Mapping[int, Rig], disturbances: Mapping[int, Disturbance]) -> None:
        """Change trials from the present sample on; what moves keeps its motion.

        Args:
            rigs: by trial; they differ from the present ones in payload, struts, coil, latency and what the sensors
                show (range, bandwidth, scale) only. The source shakes on as before, also where its amplitude was that
                of the lower plate.
            disturbances: by trial, with times from the beginning of the run; amplitudes at the lower plate of the rig
                as the run began.
        """
        present = list(self.rigs)
        for trial, rig in rigs.items():
            design = discretize(rig)
            for constants, name in zip(self._constants, CONSTANTS, strict=True):
                constants[trial] = getattr(design, name)
            self._input[trial] = input_settings(rig)
            self._scale[trial] = sensor_scale(rig)
            self._output[trial] = output_settings(rig)
            self._delay(trial, rig, design.delay)
            present[trial] = rig
        self.rigs = tuple(present)
        if disturbances:
            for trial, disturbance in disturbances.items():
                self._disturbances[trial] = disturbance
            self._mixer = self._mix(self._first_rigs)

    def _delay(self, trial: int, rig: Rig, delay: tuple[int, int, int]) -> None:
        """Let the voltages of a trial arrive with another latency; those that are on their way keep their order."""
        self._periods_late[trial] = late = _whole_periods(rig, delay)
        self._event[trial] = np.asarray(delay[1:], dtype=float)
        depth = len(self._queue)
        missing = max(late) + 1 - depth
        if missing > 0:
            # the voltages move to their places in the longer queue; before the oldest there was the oldest
            k = self.sequence
            old = [self._queue[(k - age) % depth] for age in range(1, depth + 1)]
            queue = np.zeros((depth + missing, *self._queue.shape[1:]))
            for age in range(1, depth + missing):
                queue[(k - age) % len(queue)] = old[min(age, len(old)) - 1]
            self._queue = queue

    def displace(self, stroke: ArrayLike) -> None:
        """Hold the payload at rest with strokes (*shape, struts), m, from which the next `advance` lets it go."""
        trials, n = len(self.rigs), self.struts
        strokes = np.broadcast_to(np.asarray(stroke, dtype=float), (*self.shape, n))
        self._state[:] = 0.0
        for i, (rig, s) in enumerate(zip(self.rigs, strokes.reshape(trials, n), strict=True)):
            self._state[i, : 3 * n + 2] = equilibrium(rig, s)

    def energy(self) -> Array:
        """Give the energy stored in mechanics, stops and coils (*shape), J."""
        return stored_energy(self.rigs, self._state).reshape(self.shape)

    def _normals(self, k: int) -> Array:
        return self._normal.at(k).reshape(len(self.rigs), 2 * self.struts, self._stages)

    def sample(self) -> Sample:
        """Read the converters at the present sample; asking again gives the same."""
        reading = read_input(self._state, self._input, self._bias, self._scale, self._noise)
        n = self.struts
        shape = (*self.shape, n)
        return Sample(self.sequence, reading[:, :n].reshape(shape), reading[:, n:].reshape(shape))

    def advance(self, voltage: ArrayLike, arrival: ArrayLike | None = None) -> Truth:
        """Go on to the next sample.

        Args:
            voltage: (*shape, struts) V, computed from the present sample; limited and quantized as the rig says.
            arrival: (*shape, struts) or less, s after the present sample, when it takes effect; in realtime, where
                it is measured. Limited to the period and rounded to the fine grid; NaN: nothing arrived, the old
                voltage stays. None: the rig's `input_delay`, which may be longer than a period.

        Returns:
            The truth from the present sample to the next.

        Raises:
            SatvibError: a voltage that is not a finite number, or of the wrong shape.
        """
        trials, n = len(self.rigs), self.struts
        asked = checked_voltage(voltage, (*self.shape, n), self.sequence)
        terminal = drive_output(asked.reshape(trials, n), self._output)
        self.terminal_voltage = terminal.reshape(*self.shape, n)
        k = self.sequence
        if arrival is None:
            depth = len(self._queue)
            self._queue[k % depth] = terminal
            late = (k - self._periods_late) % depth
            command = self._queue[late, np.arange(trials)[:, None], np.arange(n)]
            event = self._event
        else:
            command = terminal
            stated = np.broadcast_to(np.asarray(arrival, dtype=float), (*self.shape, n))
            steps = np.clip(np.rint(stated / self.fine_period), 0.0, self.n_fine)
            event = np.zeros((trials, n, 2))
            # a step below 0 never comes
            event[..., 0] = np.where(np.isnan(stated), -1.0, steps).reshape(trials, n)
        upper = np.empty((trials, n, self.n_fine))
        lower = np.empty((trials, self.n_fine))
        summary = advance_period(
            *self._constants,
            command,
            event,
            self._linear,
            self._mixer.period(k),
            self._ramp,
            self._state,
            upper,
            lower,
        )
        self.sequence = k + 1
        advance_noise(self._E, self._L, self._normals(k + 1), self._noise)
        shape = (*self.shape, n)
        fine = (*shape, self.n_fine)
        below = np.broadcast_to(lower.reshape(*self.shape, 1, self.n_fine), fine)
        stroke, peak, pull, current = (summary[:, i].reshape(shape) for i in range(4))
        return Truth(upper.reshape(fine), below, stroke, peak, pull, current)


def _whole_periods(rig: Rig, delay: tuple[int, int, int]) -> list[int]:
    """How many whole periods the voltage of each strut is late."""
    late, count = rig.acquisition.periods_late, rig.struts.count
    return [delay[0] + each for each in (late if len(late) == count else late * count)]


def _stack(designs: Sequence[Discrete], name: str) -> Array:
    return np.stack([np.asarray(getattr(d, name)) for d in designs])
