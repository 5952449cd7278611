# SPDX-FileCopyrightText: 2026 The satvib authors
# SPDX-License-Identifier: Apache-2.0
"""The messages of one strut, built once and refilled every sample."""

from typing import Any

from satvib_common.ros.convert import doubles, set_stamp

from satvib_plant_sim.plant.any_plant import AnyPlant
from satvib_plant_sim.plant.failing_plant import FailingPlant
from satvib_plant_sim.plant.plant import Sample, Truth


class StrutMessages:
    """The messages of one strut.

    Args:
        index: of the strut.
        name: of the strut.
        acceleration: an empty StrutAcceleration.
        truth: an empty StrutTruth.
        plant: for its periods.
    """

    def __init__(
        self, index: int, name: str, acceleration: Any, truth: Any, plant: AnyPlant | FailingPlant
    ) -> None:
        self.index, self.name = index, name
        self.acceleration, self.truth = acceleration, truth
        acceleration.header.frame_id = name
        acceleration.sample_period = plant.dt
        truth.header.frame_id = name
        truth.fine_period = plant.fine_period

    def sampled(self, sample: Sample, stamp: int) -> Any:
        """Fill in a sample; `stamp` in ns."""
        m, i = self.acceleration, self.index
        set_stamp(m.header.stamp, stamp)
        m.sequence = sample.sequence
        m.upper, m.lower = float(sample.upper[i]), float(sample.lower[i])
        m.upper_clipped = bool(sample.upper_clipped[i])
        m.lower_clipped = bool(sample.lower_clipped[i])
        return m

    def happened(self, truth: Truth, sequence: int, stamp: int) -> Any:
        """Fill in what happened after a sample; `stamp` in ns."""
        m, i = self.truth, self.index
        set_stamp(m.header.stamp, stamp)
        m.sequence = sequence
        m.upper, m.lower = doubles(truth.upper[i]), doubles(truth.lower[i])
        m.stroke, m.stroke_peak = float(truth.stroke[i]), float(truth.stroke_peak[i])
        m.force_peak, m.current = float(truth.force_peak[i]), float(truth.current[i])
        return m
