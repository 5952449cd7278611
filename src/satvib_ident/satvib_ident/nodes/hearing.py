# SPDX-FileCopyrightText: 2026 The satvib authors
# SPDX-License-Identifier: Apache-2.0
"""To what an identifier listens, which changes in a run: it ends a subscription that costs and brings nothing more."""

import time
from collections.abc import Callable
from typing import Any

from rclpy.qos import QoSProfile
from satvib_common.ros.delivery.endpoints import Input
from satvib_common.ros.loop.pace import PaceFollower
from satvib_common.ros.node import SatvibNode
from satvib_common.ros.reporting import QUIET

from satvib_msgs.msg import StrutAcceleration, VcaVoltage


class Hearing:
    """The subscriptions of an identifier to samples and voltages.

    Args:
        node: that listens.
        on_voltage, on_sample: take the messages.
        follow_pace: called when the node is in lockstep from now on, or no longer.
        expected: whether samples should come now.

    Attributes:
        heard_at: s of the monotonic clock, of the last sample.
    """

    def __init__(
        self,
        node: SatvibNode[Any],
        on_voltage: Callable[[VcaVoltage], None],
        on_sample: Callable[[StrutAcceleration], None],
        follow_pace: Callable[[], None],
        expected: Callable[[], bool],
    ) -> None:
        self._node = node
        self._pace = PaceFollower(node, 'acceleration', self._listen, follow_pace, expected)
        self._on_voltage, self._on_sample = on_voltage, on_sample
        self._voltages: Input | None = None
        self._samples: Input | None = None
        self.heard_at = 0.0
        self._sources: set[bytes] = set()  # of the samples, when the node ceased to listen

    @property
    def on(self) -> bool:
        """Whether samples are heard."""
        return self._samples is not None

    def is_quiet(self) -> bool:
        """Whether it listens to samples, and none has come for a while."""
        return self.on and time.monotonic() - self.heard_at > QUIET

    def begin(self) -> None:
        """Listen to voltages and samples, if it does not do so already."""
        if not self.on:
            self._pace.begin()

    def _listen(self, qos: QoSProfile) -> list[Input]:
        listen = self._node.listen_to
        self._voltages = listen(VcaVoltage, 'voltage', self._on_voltage, qos)
        self._samples = listen(StrutAcceleration, 'acceleration', self._hear, qos)
        return [self._voltages, self._samples]

    def _hear(self, message: StrutAcceleration) -> None:
        self.heard_at = time.monotonic()
        if self._pace.see(message.pace, message.sequence):
            self._on_sample(message)

    def need_no_voltages(self) -> None:
        """Cease to listen to the voltages, because the samples say what the coil got."""
        if self._voltages is not None:
            self._node.forget(self._voltages)
            self._voltages = None

    def cease(self) -> None:
        """Listen to nothing, for the rest of this run."""
        self._sources = self._present()
        self._pace.end()
        self.need_no_voltages()
        if self._samples is not None:
            self._node.forget(self._samples)
            self._samples = None

    def forget(self) -> None:
        """The subscriptions are gone already."""
        self._voltages = self._samples = None
        self._pace.end()

    def is_same_source(self) -> bool:
        """Whether a source of when the node ceased to listen is still there."""
        return bool(self._present() & self._sources)

    def is_another_source(self) -> bool:
        """Whether there is a source of samples, and none of those of when the node ceased to listen."""
        present = self._present()
        return bool(present) and not present & self._sources

    def _present(self) -> set[bytes]:
        node = self._node
        infos = node.get_publishers_info_by_topic(node.resolve_topic_name('acceleration'))
        return {bytes(info.endpoint_gid) for info in infos}
