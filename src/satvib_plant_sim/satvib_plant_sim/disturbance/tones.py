# SPDX-FileCopyrightText: 2026 The satvib authors
# SPDX-License-Identifier: Apache-2.0
"""Several tones: sum_i a_i sin(2 pi f_i t + phase_i); and a multisine, whose tones fill a band."""

import math
from collections.abc import Sequence
from dataclasses import dataclass
from functools import lru_cache
from typing import ClassVar

import numpy as np
from satvib_common.arrays import Array, Complex, Integers
from satvib_common.errors import SatvibError
from satvib_common.kernels.compile import Kernel
from satvib_common.schema import param
from satvib_common.signals.crest import low_crest_phases

from satvib_plant_sim.disturbance.base import Bank, Clock, Disturbance, Transfer
from satvib_plant_sim.disturbance.sine import Tone, sine_values
from satvib_plant_sim.disturbance.window import Window


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


@dataclass(frozen=True, kw_only=True)
class Multisine(Disturbance):
    """Equal tones at all multiples of 1 / period in a band, with phases that make the peak small.

    It repeats after `period`, so a frequency response is measured from it without leakage.
    """

    kind: str = param('multisine', 'kind', choices=('multisine',))
    rms: float = param(
        description='RMS, at the lower plate with control off', unit='m/s^2 (N)', minimum=0.0
    )
    low: float = param(description='lowest tone', unit='Hz', above=0.0)
    high: float = param(description='highest tone', unit='Hz', above=0.0)
    period: float = param(10.0, 'time after which it repeats', unit='s', above=0.0)
    pattern: int = param(0, 'which phases; another number is another multisine', minimum=0)

    def check(self) -> None:
        """Refuse a band without a tone."""
        super().check()
        if not self.multiples.size:
            raise SatvibError(
                f'low, high, period: no multiple of {1.0 / self.period:g} Hz lies between {self.low} and '
                f'{self.high} Hz'
            )

    @property
    def multiples(self) -> Integers:
        """The tones (lines) as multiples of 1 / period."""
        first = math.ceil(self.low * self.period * (1.0 - 1e-9))
        return np.arange(max(first, 1), math.floor(self.high * self.period * (1.0 + 1e-9)) + 1)

    def highest(self) -> tuple[str, float]:
        """Give the upper edge of the band."""
        return 'high', self.high

    @classmethod
    def bank(
        cls,
        settings: Sequence[Disturbance],
        seeds: Sequence[tuple[int, ...]],  # noqa: ARG003 - the phases are those of the pattern
        clock: Clock,
        transfers: Sequence[Transfer],
    ) -> Bank:
        """One period of each row in a table."""
        rows = [s for s in settings if isinstance(s, Multisine)]
        tables = [s.table(clock.period, t) for s, t in zip(rows, transfers, strict=True)]
        return _PeriodicBank(np.array([clock.window(s) for s in rows]), tables)

    def table(self, step: float, transfer: Transfer) -> Array:
        """Give one period (points) at points `step` s apart.

        Raises:
            SatvibError: the period is no whole number of steps.
        """
        count = round(self.period / step)
        if abs(count * step - self.period) > 1e-9 * self.period:
            raise SatvibError(
                f'disturbance: period: {self.period} s is no whole number of steps of {step:g} s'
            )
        lines = self.multiples
        size = np.array([1.0 / transfer(float(f)) for f in lines / self.period])
        spectrum: Complex = np.zeros(count // 2 + 1, dtype=complex)
        phases = np.array(_phases(int(lines[0]), lines.size, self.pattern))
        level = self.rms * math.sqrt(2.0 / lines.size)
        spectrum[lines] = 0.5 * count * level * size * np.exp(1j * phases)
        return np.asarray(np.fft.irfft(spectrum, count))


@lru_cache(maxsize=16)
def _phases(first: int, size: int, pattern: int) -> tuple[float, ...]:
    """Phases of `size` lines from `first` on, searched once."""
    lines = np.arange(first, first + size)
    generator = np.random.default_rng([pattern, first, size])
    return tuple(low_crest_phases(lines, 2 * int(lines[-1]) + 2, generator).tolist())


class _PeriodicBank:
    """Rows that repeat: the windows (rows, 3), `Window`, and one period of each row."""

    def __init__(self, windows: Array, tables: list[Array]) -> None:
        self._windows, self._tables = windows, tables

    def evaluate(self, first: int, grid: Array) -> Array:
        """Give the values (rows, len(grid)) at the fine indices first + grid."""
        n = first + grid
        found = np.zeros((len(self._tables), len(grid)))
        for row, (window, table) in enumerate(zip(self._windows, self._tables, strict=True)):
            acts = (n >= window[Window.START]) & (n < window[Window.STOP])
            since = (n[acts] - window[Window.START]).astype(np.int64)
            found[row, acts] = table[since % len(table)]
        return found
