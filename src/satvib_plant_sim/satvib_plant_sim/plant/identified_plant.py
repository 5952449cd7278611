# SPDX-FileCopyrightText: 2026 The satvib authors
# SPDX-License-Identifier: Apache-2.0
"""The plant of an `IirRig`, with the interface of `Plant`."""

from collections.abc import Callable, Sequence

import numpy as np
from numpy.typing import ArrayLike
from satvib_common.arrays import Array
from satvib_common.signals.iir_filter import IirFilter

from satvib_plant_sim.disturbance.base import Disturbance
from satvib_plant_sim.disturbance.mixer import Mixer
from satvib_plant_sim.physics.noise import NormalSource
from satvib_plant_sim.plant.batch import checked_voltage, require_equal, trials_of
from satvib_plant_sim.plant.observation import Sample, Truth
from satvib_plant_sim.rig.identified_rig import IirRig, IirStrut
from satvib_plant_sim.rig.streams import Stream


class IirPlant:
    """Identified models, sample by sample.

    There is one truth per sample (n_fine is 1), which is what the models give without noise; there is no lower plate
    and no coil, so `lower`, stroke, force and current are NaN. A disturbance acts through each strut's primary path.

    Args:
        rig, disturbance, seed: as for `Plant`; all rigs of a batch agree in struts, sample rate and the orders.

    Raises:
        SatvibError: lengths or rigs that do not agree.
    """

    def __init__(
        self,
        rig: IirRig | Sequence[IirRig],
        disturbance: Disturbance | Sequence[Disturbance],
        seed: int | Sequence[int],
    ) -> None:
        rigs, disturbances, seeds, self.shape = trials_of(rig, disturbance, seed)
        self.rigs = tuple(rigs)
        require_equal('models', {len(r.models) for r in rigs})
        require_equal('acquisition.sample_rate', {r.acquisition.sample_rate for r in rigs})
        self.struts = len(rigs[0].models)
        self.dt = rigs[0].acquisition.period
        self.n_fine = 1
        self.fine_period = self.dt
        self.sequence = 0
        trials, n = len(rigs), self.struts
        self._mixer = Mixer(disturbances, seeds, [lambda _: 1.0] * trials, self.dt, 1)
        # y(k) sees u(k - delay): the plant filters u(k - 1), so a delay of one needs no coefficient in front
        self._path = _filters(rigs, lambda s: [*[0.0] * (s.delay - 1), *s.b], lambda s: s.a)
        self._primary = _filters(rigs, lambda s: s.primary_b, lambda s: s.primary_a)
        self._limit = np.array([[r.voltage_limit] for r in rigs])
        self._rms = np.array([[r.noise_rms] for r in rigs])
        self._quantum = np.array([[r.quantum] for r in rigs])
        self._bias = np.array([[r.bias] for r in rigs])
        self._normal = NormalSource(seeds, Stream.NOISE, n)
        self._nothing = np.full((*self.shape, n), np.nan)
        self._never = np.zeros((*self.shape, n), dtype=bool)  # a sampled model has no range
        self.terminal_voltage = np.zeros((*self.shape, n))
        self._output = np.zeros((trials, n))
        self._see(np.zeros((trials, n)))

    def _see(self, driven: Array) -> None:
        """Make the output of the present sample from the models' and the disturbance's parts."""
        force = self._mixer.period(self.sequence)[:, :, 0]
        total = force[:, 0] + force[:, 1] if force.shape[1] > 1 else force[:, 0]
        shaken = self._primary.step(np.repeat(total[:, None], self.struts, axis=1))
        self._output = driven + shaken

    def sample(self) -> Sample:
        """Read the present sample; asking again gives the same."""
        reading = self._output + self._rms * self._normal.at(self.sequence) + self._bias
        coarse = self._quantum > 0.0
        step = np.where(coarse, self._quantum, 1.0)
        reading = np.where(coarse, np.floor(reading / step + 0.5) * step, reading)
        upper = reading.reshape(*self.shape, self.struts)
        return Sample(self.sequence, upper, self._nothing, self._never, self._never)

    def advance(self, voltage: ArrayLike, arrival: ArrayLike | None = None) -> Truth:  # noqa: ARG002
        """Go on to the next sample.

        Args:
            voltage: (*shape, struts) V, computed from the present sample.
            arrival: of no effect: a sampled model has its latency in it.

        Returns:
            The truth at the present sample, (*shape, struts, 1).
        """
        n = self.struts
        asked = checked_voltage(voltage, (*self.shape, n), self.sequence).reshape(-1, n)
        applied = np.minimum(np.maximum(asked, -self._limit), self._limit)
        self.terminal_voltage = applied.reshape(*self.shape, n)
        truth = self._output.reshape(*self.shape, n, 1)
        nothing = self._nothing
        self.sequence += 1
        self._see(self._path.step(applied))
        return Truth(
            upper=truth,
            lower=nothing[..., None],
            stroke=nothing,
            stroke_peak=nothing,
            force_peak=nothing,
            current=nothing,
        )


def _filters(
    rigs: Sequence[IirRig],
    numerator: Callable[[IirStrut], Sequence[float]],
    denominator: Callable[[IirStrut], Sequence[float]],
) -> IirFilter:
    """One filter per strut and trial, padded with zeros to the longest."""
    rows = [[(list(numerator(s)), [1.0, *denominator(s)]) for s in r.models] for r in rigs]
    longest = [max(len(pair[i]) for row in rows for pair in row) for i in (0, 1)]
    b, a = (
        np.array([[pair[i] + [0.0] * (longest[i] - len(pair[i])) for pair in row] for row in rows])
        for i in (0, 1)
    )
    return IirFilter(b, a, (len(rigs), len(rigs[0].models)))
