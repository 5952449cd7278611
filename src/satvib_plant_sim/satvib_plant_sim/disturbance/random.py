# SPDX-FileCopyrightText: 2026 The satvib authors
# SPDX-License-Identifier: Apache-2.0
"""Band-limited random noise of a stated RMS, by index: any sample in any order gives the same bits.

White numbers xi from `default_rng([seed, ..., block])` stand at knots, every m fine steps (at least six per period of
the upper band edge). A linear-phase band-pass (Kaiser window, 60 dB) makes the knots' values, scaled so that their
variance is rms^2; a short windowed sinc, one set of weights per phase, carries them to the fine grid. What depends on
the band is designed once; a block of knots is filtered when its first sample is asked for (overlap-save). Held per
trial: two blocks, 16 to 64 kB, and the filter.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from enum import IntEnum

import numpy as np
from satvib_common.arrays import Array
from satvib_common.errors import SatvibError
from satvib_common.kernels.compile import kernel
from satvib_common.schema import param

from satvib_plant_sim.disturbance.base import Bank, Clock, Disturbance, Transfer
from satvib_plant_sim.disturbance.window import Window, acts

STOP_BAND = 60.0
REACH = 8  # knots on either side of the interpolation


class KnotSlot(IntEnum):
    """Where the knots of a row stand."""

    STEPS = 0  # fine steps per knot
    FIRST = 1  # index of the first knot that is held


@kernel('void(f8[:],f8[:],f8[:],f8[:,:],f8,f8[:],f8[:])', '(t),(p),(b),(m,w),(),(f)->(f)')
def random_values(window, p, knots, weights, first, grid, out):
    """Interpolate between knots; p is `KnotSlot`."""
    width = weights.shape[1]
    per_knot = int(p[KnotSlot.STEPS])
    for j in range(grid.shape[0]):
        n = first + grid[j]
        total = 0.0
        if acts(window, n):
            since = int(n - window[Window.START])
            knot = since // per_knot
            phase = since - knot * per_knot
            at = knot - int(p[KnotSlot.FIRST])
            for i in range(width):
                total += weights[phase, i] * knots[at + i]
        out[j] = total


@dataclass(frozen=True, kw_only=True)
class Random(Disturbance):
    """Noise in a band."""

    kind: str = param('random', 'kind', choices=('random',))
    rms: float = param(description='RMS, of the source', unit='m/s^2 (N)', minimum=0.0)
    low: float = param(0.0, 'lower edge of the band; 0: from rest', unit='Hz', minimum=0.0)
    high: float = param(description='upper edge of the band', unit='Hz', above=0.0)

    def check(self) -> None:
        """Refuse an empty band."""
        super().check()
        if self.high <= self.low:
            raise SatvibError(f'high: {self.high} Hz is not above low, {self.low} Hz')

    def highest(self) -> tuple[str, float]:
        """Give the upper edge of the band."""
        return 'high', self.high

    @classmethod
    def bank(
        cls,
        settings: Sequence[Disturbance],
        seeds: Sequence[tuple[int, ...]],
        clock: Clock,
        transfers: Sequence[Transfer],  # noqa: ARG003 - no fixed frequency
    ) -> Bank:
        """One filter per row."""
        rows = [
            _Row(s, seed, clock)
            for s, seed in zip(settings, seeds, strict=True)
            if isinstance(s, Random)
        ]
        return _RandomBank(rows)


class _Row:
    """One disturbance: its filter and its two blocks of knots."""

    def __init__(self, settings: Random, seed: tuple[int, ...], clock: Clock) -> None:
        from scipy.signal import firwin  # slow to import, and most disturbances are no noise

        rate = 1.0 / clock.period
        if settings.high > 0.4 * rate:
            raise SatvibError(
                f'disturbance: high: {settings.high} Hz is too near the fine rate, {rate:g} Hz'
            )
        self.per_knot = max(int(rate / (6.0 * settings.high)), 1)
        knot_rate = rate / self.per_knot
        transition = max(0.25 * settings.low, 0.02 * settings.high)
        taps = int((STOP_BAND - 7.95) / (14.36 * transition / knot_rate)) // 2 * 2 + 1
        edges = [settings.low, settings.high] if settings.low > 0.0 else [settings.high]
        window = ('kaiser', 0.1102 * (STOP_BAND - 8.7))
        band = firwin(taps, edges, window=window, pass_zero=settings.low == 0.0, fs=knot_rate)
        self.taps: Array = band * (settings.rms / np.sqrt(np.sum(band * band)))
        self.block = max(1 << (taps - 1).bit_length(), 1024)
        self.seed = seed
        self.start, self.window = clock.index(settings.start), clock.window(settings)
        self.weights = _interpolation(self.per_knot)
        self.at = -1

    def cover(self, first: int, count: int, knots: Array) -> None:
        """Put the knots for fine indices first.. first + count into `knots`, when they are not there."""
        since = max(first - int(self.start), 0)
        lowest = since // self.per_knot
        if (count // self.per_knot) + 2 * REACH + 2 > self.block:
            raise SatvibError('disturbance: high: too high for this sample rate')
        block = lowest // self.block
        if block != self.at:
            self.at = block
            knots[: self.block] = self._values(block)
            knots[self.block : 2 * self.block] = self._values(block + 1)

    def _values(self, block: int) -> Array:
        """Knots of one block; always by the same operations, in any order of the blocks."""
        from scipy.signal import fftconvolve

        noise = np.concatenate(
            [
                np.random.default_rng([*self.seed, b]).standard_normal(self.block)
                for b in (block, block + 1)
            ]
        )
        filtered: Array = fftconvolve(noise, self.taps)[self.block : 2 * self.block]
        return filtered


def _interpolation(per_knot: int) -> Array:
    """Weights (per_knot, 2 REACH) of the knots around a fine point, by its phase."""
    offset = np.arange(2 * REACH)[None, :] - (REACH - 1) - np.arange(per_knot)[:, None] / per_knot
    window = np.i0(8.0 * np.sqrt(np.clip(1.0 - (offset / REACH) ** 2, 0.0, None))) / np.i0(8.0)
    weights: Array = np.sinc(offset) * window
    return weights / weights.sum(axis=1, keepdims=True)


class _RandomBank:
    """Rows whose blocks are renewed one by one."""

    def __init__(self, rows: list[_Row]) -> None:
        self._rows = rows
        longest = 2 * max(row.block for row in rows)
        phases = max(row.per_knot for row in rows)
        self._knots = np.zeros((len(rows), longest))
        self._weights = np.zeros((len(rows), phases, 2 * REACH))
        for i, row in enumerate(rows):
            self._weights[i, : row.per_knot] = row.weights
        self._windows = np.array([row.window for row in rows])
        self._places = np.zeros((len(rows), len(KnotSlot)))
        self._places[:, KnotSlot.STEPS] = [row.per_knot for row in rows]

    def evaluate(self, first: int, grid: Array) -> Array:
        """Give the values (rows, len(grid)) at the fine indices first + grid."""
        for i, row in enumerate(self._rows):
            if row.start <= first + len(grid):
                row.cover(first, len(grid), self._knots[i])
                self._places[i, KnotSlot.FIRST] = float(row.at * row.block)
        result: Array = random_values(
            self._windows, self._places, self._knots, self._weights, float(first), grid
        )
        return result
