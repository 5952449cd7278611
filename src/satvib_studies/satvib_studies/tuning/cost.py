# SPDX-FileCopyrightText: 2026 The satvib authors
# SPDX-License-Identifier: Apache-2.0
"""The robust cost of gains of the centralized law, for a whole swarm on all plants in one call.

For each plant, with r the RMS of the payload's modes together and t that of the line of sight's tilt, both over their
values on the rig as it is at 0 V, v the largest RMS of a voltage over its limit, and m the modulus margin:

    J = r + tilt t + effort v^2 + penalty max(1 - m / margin, 0)^2

Where the loop is not stable, J = 1000 (1 + s), s the mean of the gains' magnitudes as shares of the box: it falls
towards no gains, where every loop is stable, so that a search that begins among unstable ones finds its way.

The cost of the gains is the mean of J over the plants and of its largest, half each: good in general, and nowhere bad.
`loop_cost` has the equations of r, t, v and m.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from satvib_common.arrays import Array, Complex, Mask
from satvib_common.errors import SatvibError
from satvib_common.schema import Schema, param
from satvib_common.signals.integrator import leaky_integrator
from satvib_experiment.scenario.memory import check_needs
from satvib_plant_sim.disturbance.base import Disturbance
from satvib_plant_sim.physics.noise import noise_floor
from satvib_plant_sim.responses.all_struts import rig_response
from satvib_plant_sim.rig.payload_shapes import payload_modes
from satvib_plant_sim.rig.rig import Rig

from satvib_studies.tuning.loop_cost import LoopFigure, controller_figures, loop_figures
from satvib_studies.tuning.plants import gain_box, perturbed, spectrum_of

UNSTABLE = 1000.0


@dataclass(frozen=True, kw_only=True)
class CostSettings(Schema):
    """What counts, and how much."""

    plants: int = param(8, 'plants, the first the rig as it is', minimum=1, maximum=1000)
    seed: int = param(1, 'seed of the plants and of a random disturbance', minimum=0)
    duration: float = param(8.0, 'of the disturbance that is looked at', unit='s', above=0.0)
    tilt: float = param(0.2, "weight of the line of sight's tilt", minimum=0.0)
    effort: float = param(0.1, 'weight of the voltage', minimum=0.0)
    penalty: float = param(5.0, 'weight of a margin that is missing', minimum=0.0)
    margin: float = param(0.5, 'modulus margin that is wanted', above=0.0, below=1.0)
    corner: float = param(0.5, 'corner of the drift-free integrators', unit='Hz', above=0.0)
    voltage_limit: float = param(20.0, 'largest voltage', unit='V', above=0.0)


class TuningCost:
    """The cost of gains on a rig under a disturbance.

    Args:
        rig: as it is.
        disturbance: what shakes it.
        settings: see `CostSettings`.
        extra: Hz, further frequencies at which margins are looked at.

    Attributes:
        sources: (e, directions) the factors of each source in the directions of base and payload.
        lower, upper: (3 modes,) the box: P of every mode, then I, then D.
        size: how many gains.

    Raises:
        SatvibError: a disturbance that leaves the payload at rest.
    """

    def __init__(
        self,
        rig: Rig,
        disturbance: Disturbance,
        settings: CostSettings | None = None,
        extra: Sequence[float] = (),
    ) -> None:
        self.rig, self.settings = rig, settings or CostSettings()
        p = self.settings
        samples = p.duration * rig.acquisition.sample_rate
        check_needs(f'cost.duration: {samples:.6g} samples', 32.0 * samples, 1e-7 * samples)
        self.plants = perturbed(rig, p.plants, p.seed)
        spectrum = spectrum_of(disturbance, rig, p.seed, p.duration, extra)
        self.frequency, self.power = spectrum.frequency, spectrum.power
        self.sources = spectrum.sources
        half = 0.5 * rig.acquisition.sample_rate
        self.noise = noise_floor(rig) ** 2 * spectrum.width / half
        found = [rig_response(plant, self.frequency) for plant in self.plants]
        self._responses = [
            np.stack([getattr(r, name) for r in found]) for name in ('read_voltage', 'true_voltage')
        ]
        # of all directions of base and payload, those in which the disturbance acts
        self._responses += [
            np.stack([getattr(r, name) @ spectrum.sources.T for r in found])
            if rig.struts.each
            else np.stack([getattr(r, name) for r in found])
            for name in ('read_source', 'true_source')
        ]
        self.modes = payload_modes(rig)
        self._strut, self._mode = self.modes.strut, self.modes.mode
        count = len(self.modes.names)
        self._tilting = np.array([float(i in self.modes.tilts) for i in range(count)])
        self._like = np.zeros(LoopFigure.MODES + count)
        b, a = leaky_integrator(p.corner, rig.acquisition.period)
        z = np.exp(-2j * math.pi * self.frequency * rig.acquisition.period)
        self._integrator = np.polyval(b[::-1], z) / np.polyval(a[::-1], z)
        low, high = gain_box(rig)
        self.lower, self.upper = low.ravel(), high.ravel()
        self.size = len(self.lower)
        self.quiet = self.figures(np.zeros((1, self.size)))[0, 0]
        if not self.level(self.quiet) > 0.0:
            raise SatvibError(
                'disturbance: leaves the payload at rest, there is nothing to tune on'
            )

    def figures(self, gains: Array) -> Array:
        """Give the figures (particles, plants, 4 + modes) of gains (particles, size), `LoopFigure`."""
        each = np.asarray(gains, dtype=float).reshape(-1, 1, 3, len(self.modes.names))
        with np.errstate(all='ignore'):
            found = loop_figures(
                each, *self._responses, self.power, self.noise, 2.0 * math.pi * self.frequency,
                self._integrator, self._strut, self._mode, self._tilting, self._like,
            )  # fmt: skip
        return np.asarray(found)

    def controller_figures(self, controller: Complex) -> Array:
        """Give the figures (plants, 4 + modes) of a controller of any kind, C (f, n, n), u = -C y."""
        with np.errstate(all='ignore'):
            found = controller_figures(
                controller, *self._responses, self.power, self.noise, 2.0 * math.pi * self.frequency, self._mode,
                self._tilting, self._like,
            )  # fmt: skip
        return np.asarray(found)

    @staticmethod
    def level(figures: Array) -> Array:
        """RMS of all modes together, m/s^2, of figures (..., 4 + modes)."""
        level: Array = np.sqrt(np.sum(figures[..., LoopFigure.MODES :] ** 2, axis=-1))
        return level

    def each(self, gains: Array) -> Array:
        """Give J (particles, plants) of gains (particles, size)."""
        f = self.figures(gains)
        share = np.abs(np.asarray(gains, dtype=float)) / np.maximum(np.abs(self.lower), self.upper)
        astray = UNSTABLE * (1.0 + np.mean(share, axis=-1))
        return np.asarray(np.where(self.stable(f), self.of_stable(f), astray[:, None]))

    def of_stable(self, figures: Array) -> Array:
        """Give J (...) of the figures (..., 4 + modes) of stable loops."""
        p, f = self.settings, figures
        tilt = (
            f[..., LoopFigure.TILT] / self.quiet[LoopFigure.TILT]
            if self.quiet[LoopFigure.TILT] > 0.0
            else 0.0
        )
        short = np.maximum(1.0 - f[..., LoopFigure.MARGIN] / p.margin, 0.0)
        J = self.level(f) / self.level(self.quiet) + p.tilt * tilt
        return np.asarray(
            J + p.effort * (f[..., LoopFigure.VOLTS] / p.voltage_limit) ** 2 + p.penalty * short**2
        )

    @staticmethod
    def stable(figures: Array) -> Mask:
        """Whether the loops of figures (..., 4 + modes) are stable."""
        return np.asarray(np.abs(figures[..., LoopFigure.TURNS]) < 0.5)

    @staticmethod
    def together(J: Array) -> Array:
        """Give the cost (...) of J (..., plants)."""
        return np.asarray(0.5 * J.mean(axis=-1) + 0.5 * J.max(axis=-1))

    def __call__(self, gains: Array) -> Array:
        """Give the cost (particles,) of gains (particles, size)."""
        return self.together(self.each(gains))
