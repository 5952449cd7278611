# SPDX-FileCopyrightText: 2026 The satvib authors
# SPDX-License-Identifier: Apache-2.0
"""How a frequency response is estimated: estimator, window, averages, overlap, confidence."""

from dataclasses import dataclass

from satvib_common.errors import SatvibError
from satvib_common.schema import Schema, param

ESTIMATORS = ('H1', 'H2', 'Hv')
WINDOWS = ('hann', 'hamming', 'blackman', 'flattop', 'boxcar')
AVERAGES = 16  # that are aimed at where neither resolution nor averages are given


@dataclass(frozen=True, kw_only=True)
class FrfSettings(Schema):
    """Settings of an estimate; what is left out is chosen from the length of the record."""

    estimator: str = param(
        'H1',
        'H1: noise at the output only; H2: noise at the input only; Hv: noise at both',
        choices=ESTIMATORS,
    )
    window: str = param('hann', 'window of a segment', choices=WINDOWS)
    overlap: float = param(
        0.5, 'share of a segment that the next one has too', minimum=0.0, below=1.0
    )
    resolution: float | None = param(
        None, 'spacing of the lines; none: from the averages', unit='Hz', above=0.0
    )
    averages: int | None = param(
        None, f'segments to average over; none: from the resolution, or {AVERAGES}', minimum=2
    )
    confidence: float = param(
        0.95, 'probability that the true value lies in the band', above=0.0, below=1.0
    )
    noise_ratio: float = param(
        1.0, 'Hv: power of the noise at the output, in terms of that at the input', above=0.0
    )

    def check(self) -> None:
        """Refuse two ways of choosing the same thing."""
        if self.resolution is not None and self.averages is not None:
            raise SatvibError('resolution, averages: each sets the other, give one of them')

    def segment(self, samples: int, dt: float) -> int:
        """Give the length of a segment in samples.

        Args:
            samples: of the record.
            dt: s.

        Raises:
            SatvibError: the record is too short for two segments, or for the averages.
        """
        if self.resolution is not None:
            length = round(1.0 / (self.resolution * dt))
        else:
            wanted = self.averages or AVERAGES
            length = int(samples / (1.0 + (wanted - 1) * (1.0 - self.overlap)))
        if length < 8 or samples < length + self.hop(length):
            asked = (
                f'a resolution of {self.resolution:g} Hz'
                if self.resolution is not None
                else f'{self.averages or AVERAGES} averages'
            )
            raise SatvibError(
                f'{samples} samples ({samples * dt:.3g} s) are too few for {asked} with an overlap of '
                f'{self.overlap:g}'
            )
        return length

    def hop(self, length: int) -> int:
        """Give the samples from one segment of that length to the next."""
        return max(round(length * (1.0 - self.overlap)), 1)
