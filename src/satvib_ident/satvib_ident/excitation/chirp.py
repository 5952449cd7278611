# SPDX-FileCopyrightText: 2026 The satvib authors
# SPDX-License-Identifier: Apache-2.0
"""Linear sweep from one frequency to another, over and over.

    u(t) = amplitude sin(2 pi (low t + (high - low) t^2 / (2 period))),  t within the period

Strut s starts s / struts of a period into the sweep.
"""

import math
from dataclasses import dataclass

from satvib_common.errors import SatvibError
from satvib_common.schema import param

from satvib_ident.excitation.signal import Excitation


@dataclass(frozen=True, kw_only=True)
class Chirp(Excitation):
    """A sine whose frequency runs linearly from low to high."""

    low: float = param(1.0, 'first frequency', unit='Hz', above=0.0)
    high: float = param(25.0, 'last frequency', unit='Hz', above=0.0)
    period: float = param(2.0, 'length of a sweep', unit='s', above=0.0)

    def check(self) -> None:
        """Refuse what the sample rate cannot carry."""
        if max(self.low, self.high) * self.dt >= 0.5:
            raise SatvibError(
                f'low, high: {max(self.low, self.high)} Hz is not below half the sample rate, '
                f'{0.5 / self.dt:g} Hz'
            )

    def at(self, i: int) -> float:
        """Voltage in V at sample i."""
        t = math.fmod(i * self.dt + self.strut * self.period / self.struts, self.period)
        turns = self.low * t + (self.high - self.low) * t * t / (2.0 * self.period)
        return self.amplitude * math.sin(2.0 * math.pi * turns)
