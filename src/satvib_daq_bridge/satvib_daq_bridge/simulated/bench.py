# SPDX-FileCopyrightText: 2026 The satvib authors
# SPDX-License-Identifier: Apache-2.0
"""A simulated rig on a bench: volts at the converters' terminals in, volts at the sensors out.

It rests, without a disturbance, until `begin`, so that a bias can be measured first, as on a real bench. `begin` puts
a new plant in its place. Sample 0 of that plant is the present one, so the disturbance has the times of its scenario.
"""

from collections.abc import Mapping
from typing import Any

import numpy as np
from satvib_common.arrays import Array
from satvib_common.errors import SatvibError
from satvib_plant_sim.disturbance.factory import make_disturbance
from satvib_plant_sim.plant.plant import Plant, Truth
from satvib_plant_sim.rig.fine_grid import fitted_grid
from satvib_plant_sim.rig.rig import Rig


class Bench:
    """A rig with its acquisition.

    Args:
        rig: what is simulated; its converters quantize, its amplifier amplifies.
        disturbance: as in a scenario; empty for none.
        seed: of everything random.

    Attributes:
        begun: whether the disturbance's time runs.
    """

    def __init__(self, rig: Rig, disturbance: Mapping[str, Any], seed: int) -> None:
        self._disturbance = make_disturbance(dict(disturbance) or {'kind': 'none'})
        self.rig = fitted_grid(rig, [self._disturbance])
        self.struts = rig.struts.count
        self._seed = seed
        self._plant = Plant(self.rig, make_disturbance({'kind': 'none'}), seed)
        self.begun = False

    def check_rate(self, rate: float) -> None:
        """Refuse a sample rate that is not the rig's.

        Raises:
            SatvibError: they differ.
        """
        own = self.rig.acquisition.sample_rate
        if not abs(own / rate - 1.0) <= 1e-9:
            raise SatvibError(
                f'sample_rate: {rate:g} Hz, but rig {self.rig.name} samples at {own:g} Hz; make them '
                'equal (acquisition.sample_rate of the rig)'
            )

    def begin(self) -> None:
        """Begin the disturbance's time at the present sample, with a fresh plant."""
        self._plant = Plant(self.rig, self._disturbance, self._seed)
        self.begun = True

    def volts(self) -> Array:
        """Volts of the upper sensors, then the lower ones (2 struts), at the present sample."""
        sample, sensor = self._plant.sample(), self.rig.accelerometer
        acceleration = np.concatenate([sample.upper, sample.lower])
        return sensor.zero_voltage + sensor.sensitivity * acceleration

    def advance(self, volts: Array, arrival: float | None = None) -> Truth:
        """Apply volts at the output terminals (struts) and go to the next sample.

        `arrival` is s after the present sample; None: the rig's own delay.
        """
        return self._plant.advance(volts * self.rig.coil.gain, arrival)
