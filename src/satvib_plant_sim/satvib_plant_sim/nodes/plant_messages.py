# SPDX-FileCopyrightText: 2026 The satvib authors
# SPDX-License-Identifier: Apache-2.0
"""The sample of one strut as a message, built once and refilled every sample."""

from typing import Any

from satvib_common.ros.convert import set_stamp
from satvib_common.ros.delivery.wire import blank

from satvib_msgs.msg import StrutAcceleration
from satvib_plant_sim.plant.plant import Sample


class StrutMessage:
    """The acceleration of one strut.

    Args:
        index: of the strut.
        name: of the strut.
        period: s, between samples.
    """

    def __init__(self, index: int, name: str, period: float) -> None:
        self.index, self.name = index, name
        self.acceleration = blank(StrutAcceleration)
        self.acceleration.header.frame_id = name
        self.acceleration.sample_period = period

    def sampled(self, sample: Sample, stamp: int) -> Any:
        """Fill in a sample; `stamp` in ns."""
        m, i = self.acceleration, self.index
        set_stamp(m.header.stamp, stamp)
        m.sequence = sample.sequence
        m.upper, m.lower = float(sample.upper[i]), float(sample.lower[i])
        m.upper_clipped = bool(sample.upper_clipped[i])
        m.lower_clipped = bool(sample.lower_clipped[i])
        return m
