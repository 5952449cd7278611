# SPDX-FileCopyrightText: 2026 The satvib authors
# SPDX-License-Identifier: Apache-2.0
"""The plant: what the board reads and what a voltage does, for one rig or for a batch.

plant = Plant(load_rig('paper_3dof'), make_disturbance({...}), seed=1)
sample = plant.sample()              # .sequence, .upper, .lower
truth = plant.advance(voltage)       # noise-free, between this sample and the next
"""

from collections.abc import Mapping, Sequence
from functools import partial

import numpy as np
from numpy.typing import ArrayLike
from satvib_common.arrays import Array

from satvib_plant_sim.disturbance.base import Disturbance
from satvib_plant_sim.disturbance.mixer import Mixer
from satvib_plant_sim.physics.converters import (
    drawn_bias,
    drive_output,
    input_settings,
    output_settings,
    read_input,
    sensor_scale,
)
from satvib_plant_sim.physics.energy import stored_energy
from satvib_plant_sim.physics.modes import equilibrium
from satvib_plant_sim.physics.noise import NoiseModel, NormalSource, advance_noise, noise_model
from satvib_plant_sim.physics.state import lower_readings, size_of, state_size
from satvib_plant_sim.plant.batch import agree, checked_voltage, trials_of
from satvib_plant_sim.plant.latency import VoltageQueue, measured_events
from satvib_plant_sim.plant.observation import Sample, Truth
from satvib_plant_sim.responses.continuous import source_transfer
from satvib_plant_sim.rig.rig import Rig
from satvib_plant_sim.rig.streams import Stream
from satvib_plant_sim.stepping.design import DesignArrays, layout_of
from satvib_plant_sim.stepping.discretize import discretize
from satvib_plant_sim.stepping.hold import resting_ramps
from satvib_plant_sim.stepping.period import advance_period

__all__ = ['Plant', 'Sample', 'Truth']


class Plant:
    """Simulated rigs, sample by sample.

    Args:
        rig, disturbance, seed: one each for a plant of shape (); sequences of equal length for a batch of trials, of
            which single ones are shared. All rigs of a batch agree in struts, sample rate, fine steps and the order
            of the anti-alias filter.

    A trial holds 30 to 55 kB (six struts: 150 kB), with random disturbances up to 50 kB more, however long it runs.

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
        self._size = size_of(first)
        self._layout = layout_of(self._size)
        self.struts = self._size.struts
        self.dt = first.acquisition.period
        self.n_fine = first.acquisition.fine_steps
        self.fine_period = self.dt / self.n_fine
        self.sequence = 0

        trials, n = len(rigs), self.struts
        self._mixer = self._mix(rigs)
        self._designs = DesignArrays(
            *(np.stack(rows) for rows in zip(*(d.arrays for d in designs), strict=True))
        )
        self._linear = np.array([float(r.acquisition.hold == 'linear') for r in rigs])
        self._on_the_way = VoltageQueue(rigs, [d.delay for d in designs], n)

        self._state = np.zeros((trials, self._designs.force.shape[-1]))
        self._ramp = resting_ramps(trials, n, self.n_fine)
        self._input = np.array([input_settings(r) for r in rigs])
        self._output = np.array([output_settings(r) for r in rigs])
        self._scale = np.array([sensor_scale(r) for r in rigs])
        self._bias = np.array([drawn_bias(r, s) for r, s in zip(rigs, seeds, strict=True)])
        models = [noise_model(r) for r in rigs]
        self._noise_models = NoiseModel(*(np.stack(rows) for rows in zip(*models, strict=True)))
        self._stages = self._noise_models.step.shape[-1]
        self._normal = NormalSource(seeds, Stream.NOISE, 2 * n * self._stages)
        self._noise = np.zeros((trials, 2 * n, self._stages))
        start = self._noise_models.start
        advance_noise(np.zeros_like(start), start, self._normals(0), self._noise)
        self.terminal_voltage = np.zeros((*self.shape, n))

    def _mix(self, rigs: Sequence[Rig]) -> Mixer:
        """Put the disturbances together; amplitudes are at the lower plates of these rigs."""
        for disturbance in self._disturbances:
            disturbance.check_points(1.0 / self.fine_period)
        transfers = [partial(source_transfer, r) for r in rigs]
        directions = self._size.plate, self._size.payload
        return Mixer(
            self._disturbances, self._seeds, transfers, self.fine_period, self.n_fine, directions
        )

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
            for rows, row in zip(self._designs, design.arrays, strict=True):
                rows[trial] = row
            self._input[trial] = input_settings(rig)
            self._scale[trial] = sensor_scale(rig)
            self._output[trial] = output_settings(rig)
            self._on_the_way.change(trial, rig, design.delay, self.sequence)
            present[trial] = rig
        self.rigs = tuple(present)
        if disturbances:
            for trial, disturbance in disturbances.items():
                self._disturbances[trial] = disturbance
            self._mixer = self._mix(self._first_rigs)

    def displace(self, stroke: ArrayLike) -> None:
        """Hold the payload at rest with strokes (*shape, struts), m; the next `advance` releases it."""
        trials, n = len(self.rigs), self.struts
        strokes = np.broadcast_to(np.asarray(stroke, dtype=float), (*self.shape, n))
        self._state[:] = 0.0
        for i, (rig, s) in enumerate(zip(self.rigs, strokes.reshape(trials, n), strict=True)):
            self._state[i, : state_size(self._size)] = equilibrium(rig, s)

    def energy(self) -> Array:
        """Give the energy stored in mechanics, stops and coils (*shape), J."""
        return stored_energy(self.rigs, self._state).reshape(self.shape)

    def _normals(self, k: int) -> Array:
        return self._normal.at(k).reshape(len(self.rigs), 2 * self.struts, self._stages)

    def sample(self) -> Sample:
        """Read the converters at the present sample; asking again gives the same."""
        chains = self._state[:, -self._layout.lanes :]
        lower = float(lower_readings(self._size))
        reading, ends = read_input(chains, lower, self._input, self._bias, self._scale, self._noise)
        clipped = ends > 0.0
        n = self.struts
        shape = (*self.shape, n)
        return Sample(
            sequence=self.sequence,
            upper=reading[:, :n].reshape(shape),
            lower=reading[:, n:].reshape(shape),
            upper_clipped=clipped[:, :n].reshape(shape),
            lower_clipped=clipped[:, n:].reshape(shape),
        )

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
            command, event = self._on_the_way.pass_on(k, terminal)
        else:
            stated = np.broadcast_to(np.asarray(arrival, dtype=float), (*self.shape, n))
            event = measured_events(stated.reshape(trials, n), self.fine_period, self.n_fine)
            command = terminal
        upper = np.empty((trials, n, self.n_fine))
        lower = np.empty((trials, lower_readings(self._size), self.n_fine))
        stroke, stroke_peak, force_peak, current = advance_period(
            *self._designs,
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
        noise = self._noise_models
        advance_noise(noise.step, noise.drive, self._normals(k + 1), self._noise)
        shape = (*self.shape, n)
        fine = (*shape, self.n_fine)
        below = np.broadcast_to(lower.reshape(*self.shape, -1, self.n_fine), fine)
        return Truth(
            upper=upper.reshape(fine),
            lower=below,
            stroke=stroke.reshape(shape),
            stroke_peak=stroke_peak.reshape(shape),
            force_peak=force_peak.reshape(shape),
            current=current.reshape(shape),
        )
