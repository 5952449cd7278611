# SPDX-FileCopyrightText: 2026 The satvib authors
# SPDX-License-Identifier: Apache-2.0
"""The kinds of designs that can be searched: which numbers are free, in which box, and which controller they give."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np
from satvib_common.arrays import Array
from satvib_control.laws.state_space.matrices import Matrices
from satvib_plant_sim.physics.noise import noise_floor
from satvib_plant_sim.rig.rig import Rig

from satvib_studies.design.lqg import design_lqg
from satvib_studies.design.model import Shaking, design_model
from satvib_studies.design.notch import design_notch
from satvib_studies.tuning.plants import gain_box
from satvib_studies.tuning.search import UNTUNED


class Free(NamedTuple):
    """One free number: its box, in its own unit, where a search begins, and whether its logarithm is searched."""

    low: float
    high: float
    start: float
    log: bool = True

    def coordinate(self, value: float) -> float:
        """Give the coordinate of a value; what is outside the box is moved to its wall."""
        inside = min(max(value, self.low), self.high)
        return math.log10(inside) if self.log else inside

    def value(self, coordinate: float) -> float:
        """Give the value of a coordinate."""
        return float(10.0**coordinate if self.log else coordinate)


@dataclass(frozen=True)
class Kind:
    """A kind of design.

    Attributes:
        section: of a scenario, into which its parameters belong.
        free: the free numbers by name.
        make: from their values to the controller, of one strut or of all (`section`).
    """

    section: str
    free: dict[str, Free]
    make: Callable[[dict[str, float]], Matrices]

    @property
    def alone(self) -> bool:
        """Whether the controller is that of one strut."""
        return self.section == 'controller'

    def values(self, position: Array) -> dict[str, float]:
        """Give the values of coordinates (free,)."""
        return {
            name: free.value(float(x))
            for (name, free), x in zip(self.free.items(), position, strict=True)
        }

    def box(self) -> tuple[Array, Array, Array]:
        """Give the walls of the box and the start, (free,) each, as coordinates."""
        rows = [
            (f.coordinate(f.low), f.coordinate(f.high), f.coordinate(f.start))
            for f in self.free.values()
        ]
        low, high, start = np.array(rows).T
        return low, high, start


def lqg_kind(
    rig: Rig, frequency: float, level: float, directions: tuple[tuple[float, ...], ...] = ()
) -> Kind:
    """Give LQG: what a volt counts, and what the design is told of noise and tone.

    Args:
        rig: as it is.
        frequency: Hz, of the tone.
        level: m/s^2 RMS, of the tone at the source.
        directions: of listed struts: see `Shaking`.
    """

    def make(v: dict[str, float]) -> Matrices:
        shaking = Shaking(
            frequency=frequency, tone=v['tone'], damping=v['tone_damping'],
            voltage_noise=v['voltage_noise'], sensor_noise=v['sensor_noise'], directions=directions,
        )  # fmt: skip
        return design_lqg(design_model(rig, shaking), v['voltage_weight']).matrices

    free = {
        'voltage_weight': Free(1e-3, 3.0, 0.1),  # m/s^2 per V
        'sensor_noise': Free(1e-3, 3.0, noise_floor(rig)),  # m/s^2
        'voltage_noise': Free(1e-3, 3.0, 1e-3),  # V
        'tone': Free(1e-3, 3.0, level),  # m/s^2
        'tone_damping': Free(1e-4, 0.3, 1e-3),
    }
    return Kind('centralized', free, make)


def notch_kind(rig: Rig, frequency: float, corner: float) -> Kind:
    """Give a damper with a notch at each strut: gains, and gain, phase and width of the resonator.

    Args:
        rig: as it is.
        frequency: Hz, of the tone.
        corner: Hz, of the integrators.
    """
    dt = rig.acquisition.period

    def make(v: dict[str, float]) -> Matrices:
        gains = v['gain_p'], v['gain_i'], v['gain_d']
        return design_notch(gains, corner, frequency, v['width'], v['gain'], v['phase'], dt)

    low, high = (rows[:, 0] for rows in gain_box(rig))
    free = {
        'gain_p': Free(low[0], high[0], UNTUNED, log=False),
        'gain_i': Free(low[1], high[1], 0.0, log=False),
        'gain_d': Free(low[2], high[2], 0.0, log=False),
        'gain': Free(1e-5, 3.0, 1e-5),  # V/(m/s^2)
        'phase': Free(-math.pi, math.pi, 0.0, log=False),
        'width': Free(1e-3, 3.0, 0.1),  # Hz
    }
    return Kind('controller', free, make)
