# SPDX-FileCopyrightText: 2026 The satvib authors
# SPDX-License-Identifier: Apache-2.0
"""The I^2 t watch: the thermal load of the coils, from the current that their voltage drives.

    L i' = V - R i          (voltage drive; back-EMF is not known here and left out)
    i    = g V              (an amplifier that drives current, g its transconductance)
    tau load' = (i / i_c)^2 - load,    i_c = continuous force / force constant

`load` is 1 in the steady state at the continuous rating; above 1 the coil gets warmer than its rating. A current
i that stands from rest reaches it after tau ln(1 / (1 - (i_c / i)^2)). The voltage stands during a step; the heat of a
step is that of the larger of its steady and its last current.
"""

from collections.abc import Sequence

import numpy as np
from satvib_common.arrays import Array

from satvib_daq_bridge.channels import CoilChannel


class CoilLoad:
    """Estimated current and thermal load of each coil.

    Args:
        coils: the channels.

    Attributes:
        current: (coils) A, estimated.
        load: (coils), of the continuous rating; 1 is the most that may last.
    """

    def __init__(self, coils: Sequence[CoilChannel]) -> None:
        voltage_drive = np.array([c.transconductance == 0.0 for c in coils])
        per_volt = [c.transconductance or 1.0 / c.resistance for c in coils]
        self._per_volt = np.array(per_volt)
        time = np.array([c.inductance / c.resistance for c in coils])
        # an amplifier that drives current has no lag worth knowing
        self._lag = np.where(voltage_drive, time, 0.0)
        self._rated = np.array([c.continuous_current for c in coils])
        self._thermal = np.array([c.thermal_time for c in coils])
        self.current = np.zeros(len(coils))
        self.load = np.zeros(len(coils))

    def advance(self, voltage: Array, time: float) -> Array:
        """Apply a voltage (coils, V) for a time (s); gives the load (coils) after it."""
        steady = self._per_volt * voltage
        with np.errstate(divide='ignore', over='ignore'):
            fade = np.exp(-np.where(self._lag > 0.0, time / self._lag, np.inf))
        self.current = steady + (self.current - steady) * fade
        heat = (np.maximum(np.abs(steady), np.abs(self.current)) / self._rated) ** 2
        self.load = heat + (self.load - heat) * np.exp(-time / self._thermal)
        return self.load
