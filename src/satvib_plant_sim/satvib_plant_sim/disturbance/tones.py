# SPDX-FileCopyrightText: 2026 The satvib authors
# SPDX-License-Identifier: Apache-2.0
"""Several tones: sum_i a_i sin(2 pi f_i t + phase_i)."""

import math
from dataclasses import dataclass
from typing import ClassVar

from satvib_common.errors import SatvibError
from satvib_common.kernels.compile import Kernel
from satvib_common.schema import param

from satvib_plant_sim.disturbance.base import Disturbance, Transfer
from satvib_plant_sim.disturbance.sine import Tone, sine_values


@dataclass(frozen=True, kw_only=True)
class Tones(Disturbance):
    """Several tones."""

    kind: str = param('tones', 'kind', choices=('tones',))
    amplitudes: tuple[float, ...] = param(
        description='of each tone, at the lower plate with control off', unit='m/s^2 (N)'
    )
    frequencies: tuple[float, ...] = param(description='of each tone', unit='Hz', above=0.0)
    phases: tuple[float, ...] = param((), 'of each tone at start; none: all 0', unit='deg')

    KERNEL: ClassVar[Kernel] = sine_values

    def check(self) -> None:
        """Refuse lists of different lengths."""
        super().check()
        count = len(self.frequencies)
        if count == 0:
            raise SatvibError('frequencies: empty')
        if len(self.amplitudes) != count:
            raise SatvibError(f'amplitudes: {len(self.amplitudes)} for {count} frequencies')
        if len(self.phases) not in {0, count}:
            raise SatvibError(f'phases: {len(self.phases)} for {count} frequencies')

    def tones(self) -> tuple[float, ...]:
        """Give the frequencies."""
        return self.frequencies

    def highest(self) -> tuple[str, float]:
        """Give the highest frequency."""
        return 'frequencies', max(self.frequencies)

    def lines(self, transfer: Transfer) -> list[Tone]:
        """Give the tones."""
        phases = self.phases or (0.0,) * len(self.frequencies)
        return [
            Tone(amplitude=a / transfer(f), speed=2.0 * math.pi * f, phase=math.radians(p))
            for a, f, p in zip(self.amplitudes, self.frequencies, phases, strict=True)
        ]

    def values(self, transfer: Transfer) -> list[float]:
        """The numbers of each tone, one after the other."""
        return [number for tone in self.lines(transfer) for number in tone]
