# SPDX-FileCopyrightText: 2026 The satvib authors
# SPDX-License-Identifier: Apache-2.0
"""What daq_bridge publishes of each sample: the accelerations of its struts, and what their coils got."""

from collections.abc import Callable, Sequence
from typing import Any

from satvib_common.ros.convert import set_stamp
from satvib_common.ros.loop.applied_block import AppliedBlocks
from satvib_common.struts.applied import Pace

from satvib_daq_bridge.bridge.bridge import Published
from satvib_msgs.msg import StrutAcceleration, VoltageApplied

_BLOCK = 10  # samples


class BridgeOutputs:
    """The publishers and the messages that are refilled.

    Args:
        publish_on: makes a publisher of a kind, for a topic.
        struts: their names.
        period: s, sample period.
        virtual: the device waits for the voltages.
    """

    def __init__(
        self, publish_on: Callable[..., Any], struts: Sequence[str], period: float, virtual: bool
    ) -> None:
        self._period = round(period * 1e9)
        self._outs = [publish_on(StrutAcceleration, f'{s}/acceleration') for s in struts]
        pace = int(Pace.LOCKSTEP if virtual else Pace.CLOCK)
        self._messages = [StrutAcceleration(sample_period=period, pace=pace) for _ in struts]
        for message, name in zip(self._messages, struts, strict=True):
            message.header.frame_id = name
        self._applied = AppliedBlocks(struts, VoltageApplied, publish_on, _BLOCK)

    def publish(self, published: Published, stamp: int, why: str) -> None:
        """Publish a sample (stamp in ns); `why`: reason of the state in which the coils got what they got."""
        for i, (message, out) in enumerate(zip(self._messages, self._outs, strict=True)):
            set_stamp(message.header.stamp, stamp)
            message.sequence = published.sequence
            message.upper, message.lower = float(published.upper[i]), float(published.lower[i])
            message.applied = float(published.applied[i])
            message.applied_state = int(published.applied_state[i])
            message.upper_clipped = bool(published.upper_clipped[i])
            message.lower_clipped = bool(published.lower_clipped[i])
            out.publish(message)
        if published.sequence:
            before = published.sequence - 1, stamp - self._period
            reasons = [why] * len(self._outs)
            self._applied.add(published.applied, published.applied_state, reasons, *before)
