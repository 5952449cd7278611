# SPDX-FileCopyrightText: 2026 The satvib authors
# SPDX-License-Identifier: Apache-2.0
"""What a plant publishes for its struts: samples at once, truth and applied voltages in blocks."""

from collections.abc import Callable, Sequence
from typing import Any

from satvib_common.arrays import Array, Integers
from satvib_common.ros.convert import set_stamp
from satvib_common.ros.delivery.wire import blank
from satvib_common.ros.loop.applied_block import AppliedBlocks
from satvib_common.struts.applied import Pace

from satvib_msgs.msg import StrutAcceleration, StrutTruth, VoltageApplied
from satvib_plant_sim.nodes.realtime_commands import Commands
from satvib_plant_sim.nodes.truth_block import TruthBlock
from satvib_plant_sim.plant.any_plant import AnyPlant
from satvib_plant_sim.plant.failing_plant import FailingPlant
from satvib_plant_sim.plant.observation import Truth
from satvib_plant_sim.plant.plant import Sample


class StrutMessage:
    """The acceleration of one strut.

    Args:
        index: of the strut.
        name: of the strut.
        period: s, between samples.
        pace: how they follow each other.
    """

    def __init__(self, index: int, name: str, period: float, pace: Pace) -> None:
        self.index, self.name = index, name
        self.acceleration = blank(StrutAcceleration)
        self.acceleration.header.frame_id = name
        self.acceleration.sample_period = period
        self.acceleration.pace = int(pace)

    def sampled(self, sample: Sample, stamp: int, applied: Array, state: Integers) -> Any:
        """Fill in a sample; `stamp` in ns, and what the coils (struts) got before it: V, and an `Applied`."""
        m, i = self.acceleration, self.index
        set_stamp(m.header.stamp, stamp)
        m.sequence = sample.sequence
        m.upper, m.lower = float(sample.upper[i]), float(sample.lower[i])
        m.upper_clipped = bool(sample.upper_clipped[i])
        m.lower_clipped = bool(sample.lower_clipped[i])
        m.applied, m.applied_state = float(applied[i]), int(state[i])
        return m


class PlantOutputs:
    """The messages of all struts with their publishers.

    Args:
        publish_on: makes a publisher of a kind, for a topic; with `spared` if nobody waits for its messages.
        names: of the struts.
        plant: whose samples are published.
        pace: how they follow each other.
        block: samples of a block of truth.
    """

    def __init__(
        self,
        publish_on: Callable[..., Any],
        names: Sequence[str],
        plant: AnyPlant | FailingPlant,
        pace: Pace,
        block: int,
    ) -> None:
        self._messages = [StrutMessage(i, name, plant.dt, pace) for i, name in enumerate(names)]
        self._samples_out = [publish_on(StrutAcceleration, f'{n}/acceleration') for n in names]
        outs = [publish_on(StrutTruth, f'{n}/truth', spared=True) for n in names]
        truths = [StrutTruth(fine_period=plant.fine_period) for _ in names]
        self._truth = TruthBlock(names, truths, outs, block)
        self._applied = AppliedBlocks(names, VoltageApplied, publish_on, block)

    def sample(self, sample: Sample, stamp: int, commands: Commands) -> None:
        """Publish a sample, with what the coils got before it."""
        voltage, state = commands.voltage, commands.state
        for message, publisher in zip(self._messages, self._samples_out, strict=True):
            publisher.publish(message.sampled(sample, stamp, voltage, state))

    def period(self, truth: Truth, k: int, stamp: int, commands: Commands, at_once: bool) -> None:
        """Take what happened in the period after sample k; a block that is whole goes out `at_once`, or later."""
        self._truth.add(truth, k, stamp, at_once=at_once)
        self._applied.add(commands.voltage, commands.state, commands.why, k, stamp)

    def flush_whole(self) -> None:
        """Publish the blocks of truth that are whole."""
        self._truth.flush_whole()

    def flush(self) -> None:
        """Publish what has been gathered."""
        self._truth.flush()
        self._applied.flush()
