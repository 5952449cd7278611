# SPDX-FileCopyrightText: 2026 The satvib authors
# SPDX-License-Identifier: Apache-2.0
"""What a plant gives: a sample as the acquisition reads it, and the truth of a period."""

from dataclasses import dataclass

from satvib_common.arrays import Array, Mask


@dataclass(frozen=True)
class Sample:
    """What the acquisition reads at one instant.

    Attributes:
        sequence: index of the sample.
        upper, lower: (*shape, struts) m/s^2, with bias, noise and quantization.
        upper_clipped, lower_clipped: (*shape, struts) the sensor stands at an end of its range.
    """

    sequence: int
    upper: Array
    lower: Array
    upper_clipped: Mask
    lower_clipped: Mask


@dataclass(frozen=True)
class Truth:
    """What really happened from one sample to the next.

    Attributes:
        upper, lower: (*shape, struts, n_fine) m/s^2 at the fine points, the first at the sample; right limits.
        stroke: (*shape, struts) m, at the sample.
        stroke_peak: (*shape, struts) m, largest magnitude in the period.
        force_peak: (*shape, struts) N, largest magnitude of the coil's force in the period.
        current: (*shape, struts) A, at the sample.
    """

    upper: Array
    lower: Array
    stroke: Array
    stroke_peak: Array
    force_peak: Array
    current: Array
