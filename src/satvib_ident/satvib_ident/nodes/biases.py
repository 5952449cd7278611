# SPDX-FileCopyrightText: 2026 The satvib authors
# SPDX-License-Identifier: Apache-2.0
"""The biases of a strut's sensors, as its identifier knows them, also when it joins a run after CALIBRATE.

The identifier and the controller of a strut both measure the biases in CALIBRATE. Each publishes what it has found, so
that one of them that is started again in the middle of a run takes it from the other.
"""

import math
from typing import Any

import numpy as np
from satvib_common.phases import Phase, PhasePlan
from satvib_common.signals.calibration import BiasCalibration


class Biases:
    """Measures the lower bias, and knows whether the upper one is still awaited."""

    def __init__(self) -> None:
        self.awaited = False
        self._lower = BiasCalibration()
        self._given = math.nan
        self._begun = False

    def begin(self) -> None:
        """Begin a run."""
        self._lower.reset()
        self._given, self._begun, self.awaited = math.nan, False, False

    def see(self, sample: Any, plan: PhasePlan) -> None:
        """Take a sample; the first one of a run shows whether CALIBRATE is over already."""
        k = sample.sequence
        phase = plan.at(k)
        if not self._begun:
            self._begun = True
            start = plan.first_of(Phase.CALIBRATE)
            self.awaited = start is not None and start < k and phase is not Phase.CALIBRATE
        if phase is Phase.CALIBRATE:
            self._lower.add(np.asarray(math.nan if sample.lower_clipped else sample.lower))

    def take(self, state: Any) -> float:
        """Take the biases of a controller's state; gives the upper one, m/s^2."""
        self.awaited, self._given = False, float(state.bias_lower)
        return float(state.bias_upper)

    @property
    def lower(self) -> float:
        """Bias of the lower sensor, m/s^2; NaN while unknown."""
        return float(self._lower.mean) if self._lower.count > 0 else self._given
