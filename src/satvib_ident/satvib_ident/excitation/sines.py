# SPDX-FileCopyrightText: 2026 The satvib authors
# SPDX-License-Identifier: Apache-2.0
"""The sum of sines, by default of 1 Hz and 2 Hz: what the paper's text names.

    u(i) = amplitude / F * sum_f sin(2 pi f i dt + shift)

F sines excite only 2 F parameters: two cannot identify the five of a second-order model.
"""

import math
from dataclasses import dataclass

from satvib_common.schema import param

from satvib_ident.excitation.signal import Excitation
from satvib_ident.excitation.squares import check_frequencies


@dataclass(frozen=True, kw_only=True)
class Sines(Excitation):
    """Sines of equal share."""

    frequencies: tuple[float, ...] = param((1.0, 2.0), 'frequencies', unit='Hz', above=0.0)

    def check(self) -> None:
        """Refuse what the sample rate cannot carry."""
        check_frequencies(self.frequencies, self.dt)

    def at(self, i: int) -> float:
        """Voltage in V at sample i."""
        time = i * self.dt + self.strut / self.struts / min(self.frequencies)
        total = 0.0
        for f in self.frequencies:
            total += math.sin(2.0 * math.pi * f * time)
        return self.amplitude * total / len(self.frequencies)
