# SPDX-FileCopyrightText: 2026 The satvib authors
# SPDX-License-Identifier: Apache-2.0
"""Band-limited random noise: Gaussian lines in a band, limited to three deviations, repeated after a long period.

Each strut has a stream of its own: default_rng([seed, strut]).
"""

from dataclasses import dataclass

import numpy as np
from satvib_common.arrays import Array
from satvib_common.levels import rms_with_mean
from satvib_common.schema import param

from satvib_ident.excitation.periodic import PeriodicExcitation


@dataclass(frozen=True, kw_only=True)
class BandRandom(PeriodicExcitation):
    """Noise with a flat density in the band."""

    period: float = param(60.0, 'time after which the noise repeats', unit='s', above=0.0)

    def table(self) -> Array:
        """One period, limited to three deviations."""
        generator = np.random.default_rng([self.seed, self.strut])
        spectrum = np.zeros(self.count // 2 + 1, dtype=complex)
        lines = self.lines
        spectrum[lines] = generator.normal(size=lines.size) + 1j * generator.normal(size=lines.size)
        signal = np.fft.irfft(spectrum, self.count)
        limit = 3.0 * float(rms_with_mean(signal))
        return np.asarray(np.clip(signal, -limit, limit))
