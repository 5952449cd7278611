# SPDX-FileCopyrightText: 2026 The satvib authors
# SPDX-License-Identifier: Apache-2.0
"""Parameters of the law `narrowband`."""

from dataclasses import dataclass

from satvib_common.errors import SatvibError
from satvib_common.schema import Fixed, param

from satvib_control.laws.parameters import LawParameters


@dataclass(frozen=True, kw_only=True)
class NarrowbandParameters(LawParameters):
    """Which tones are sought, and how fast they are followed."""

    narrowband_tones: int = param(
        3, 'largest number of tones', minimum=1, maximum=8, read_only=Fixed.MEMORY
    )
    narrowband_low: float = param(
        4.0,
        'lowest frequency of a tone that is cancelled',
        unit='Hz',
        above=0.0,
        read_only=Fixed.MEMORY,
    )
    narrowband_high: float = param(
        0.0,
        'highest frequency of a tone that is cancelled; 0: 0.45 of the sample rate',
        unit='Hz',
        minimum=0.0,
        read_only=Fixed.MEMORY,
    )
    narrowband_settling: float = param(
        0.1,
        'time constant of amplitude and phase; at least one and a half periods of the tone, and '
        'longer where the modulus margin needs it',
        unit='s',
        above=0.0,
    )
    narrowband_memory: float = param(
        5.0,
        'longest time constant of the frequency',
        unit='s',
        above=0.0,
    )
    narrowband_window: float = param(
        0.5,
        'window of the spectrum in which new tones are sought; it does not separate tones that are '
        'closer than its inverse',
        unit='s',
        above=0.0,
        read_only=Fixed.MEMORY,
    )
    narrowband_smallest: float = param(
        0.0,
        'smallest amplitude that is cancelled; a tone must also stand out of the noise',
        unit='m/s^2',
        minimum=0.0,
    )

    narrowband_serve: str = param(
        'samples',
        'what is brought to its least: the samples, or the payload between them, images of the hold included; '
        'payload needs narrowband_weights',
        choices=('samples', 'payload'),
        read_only=Fixed.RIG,
    )
    narrowband_weights: tuple[float, ...] = param(
        (),
        'frequency (Hz), real and imaginary part of the weight on the voltage of a tone, and so on by increasing '
        'frequency; a scenario makes it from its rig',
        read_only=Fixed.RIG,
    )

    def check(self) -> None:
        """Check the band of frequencies and the weights where the law is in use."""
        super().check()
        weights = self.narrowband_weights
        if 'narrowband' in self.law and self.narrowband_serve == 'payload':
            frequencies = weights[::3]
            if (
                len(weights) < 6
                or len(weights) % 3
                or list(frequencies) != sorted(set(frequencies))
            ):
                raise SatvibError(
                    f'narrowband_weights: {len(weights)} numbers; two or more rows of frequency, real and imaginary '
                    'part by increasing frequency are expected'
                )
        nyquist = 0.5 * self.sample_rate
        if 'narrowband' in self.law:
            high = self.narrowband_high or 0.45 * self.sample_rate
            if not self.narrowband_low < high < nyquist:
                raise SatvibError(
                    f'narrowband_low, narrowband_high: {self.narrowband_low} to {high} Hz is not a '
                    f'band below half the sample rate, {nyquist} Hz'
                )
