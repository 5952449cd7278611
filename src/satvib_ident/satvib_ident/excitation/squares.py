# SPDX-FileCopyrightText: 2026 The satvib authors
# SPDX-License-Identifier: Apache-2.0
"""The paper's excitation: the sum of square waves, by default of 1 Hz and 2 Hz.

    u(i) = amplitude / F * sum_f sign(sin(2 pi f (i + 1/2) dt + shift))

Half a sample in the argument keeps the edges away from rounding. Strut s runs s / struts of the slowest period ahead.
"""

import math
from dataclasses import dataclass

from satvib_common.errors import SatvibError
from satvib_common.schema import param

from satvib_ident.excitation.signal import Excitation


@dataclass(frozen=True, kw_only=True)
class Squares(Excitation):
    """Square waves of equal share."""

    frequencies: tuple[float, ...] = param((1.0, 2.0), 'fundamentals', unit='Hz', above=0.0)

    def check(self) -> None:
        """Refuse what the sample rate cannot carry."""
        check_frequencies(self.frequencies, self.dt)

    def at(self, i: int) -> float:
        """Voltage in V at sample i."""
        lead = self.strut / self.struts / min(self.frequencies)
        total = 0
        for f in self.frequencies:
            phase = ((i + 0.5) * self.dt + lead) * f
            total += 1 if phase - math.floor(phase) < 0.5 else -1
        return self.amplitude * total / len(self.frequencies)


def check_frequencies(frequencies: tuple[float, ...], dt: float) -> None:
    """Refuse an empty list and what lies at or above half the sample rate."""
    if not frequencies:
        raise SatvibError('frequencies: at least one is needed')
    if max(frequencies) * dt >= 0.5:
        raise SatvibError(
            f'frequencies: {max(frequencies)} Hz is not below half the sample rate, {0.5 / dt:g} Hz'
        )
