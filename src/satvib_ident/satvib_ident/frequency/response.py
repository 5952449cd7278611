# SPDX-FileCopyrightText: 2026 The satvib authors
# SPDX-License-Identifier: Apache-2.0
"""A measured frequency response: its value, its coherence, and the disc in which the true value lies."""

from dataclasses import dataclass
from typing import Any

import numpy as np
from satvib_common.arrays import Array, Complex
from satvib_common.levels import decibel


@dataclass(frozen=True, eq=False)
class FrequencyResponse:
    """Output per input at some frequencies.

    Attributes:
        frequency: (f,) Hz.
        value: (..., f) complex, unit of the output per unit of the input.
        coherence: (..., f) 0 to 1: share of the output's power that the input explains.
        radius: (..., f) radius of the disc around `value` in which the true value lies with the probability
            `confidence`; NaN where the record does not say.
        averages: independent averages, overlap allowed for.
        confidence: of the disc.
        method: how it was found, for people.
    """

    frequency: Array
    value: Complex
    coherence: Array
    radius: Array
    averages: float
    confidence: float
    method: str

    @property
    def magnitude(self) -> Array:
        """|value| (..., f)."""
        return np.asarray(np.abs(self.value))

    @property
    def decibels(self) -> Array:
        """Magnitude (..., f), dB."""
        return decibel(self.magnitude)

    @property
    def phase(self) -> Array:
        """Phase (..., f), degrees, without jumps of a turn."""
        return np.asarray(np.degrees(np.unwrap(np.angle(self.value), axis=-1)))

    @property
    def band(self) -> tuple[Array, Array]:
        """Least and largest magnitude (..., f) in the disc."""
        size = self.magnitude
        return np.maximum(size - self.radius, 0.0), size + self.radius

    @property
    def phase_band(self) -> Array:
        """Largest deviation of the phase in the disc (..., f), degrees; 180 where the disc holds 0."""
        with np.errstate(divide='ignore', invalid='ignore'):
            ratio = self.radius / self.magnitude
            inside = np.degrees(np.arcsin(np.minimum(ratio, 1.0)))
        return np.asarray(np.where(ratio < 1.0, inside, np.where(np.isnan(ratio), np.nan, 180.0)))

    def __getitem__(self, index: Any) -> 'FrequencyResponse':
        """Take items of the leading axes."""
        return FrequencyResponse(
            self.frequency, self.value[index], self.coherence[index], self.radius[index],
            self.averages, self.confidence, self.method,
        )  # fmt: skip

    def at_lines(self, keep: Any) -> 'FrequencyResponse':
        """Take some of the frequencies; `keep` is a mask (f,) or a slice."""
        return FrequencyResponse(
            self.frequency[keep], self.value[..., keep], self.coherence[..., keep],
            self.radius[..., keep], self.averages, self.confidence, self.method,
        )  # fmt: skip

    def between(self, low: float, high: float) -> 'FrequencyResponse':
        """Take the frequencies from `low` to `high` Hz."""
        slack = 1e-9 * high
        f = self.frequency
        return self.at_lines((f >= low - slack) & (f <= high + slack))
