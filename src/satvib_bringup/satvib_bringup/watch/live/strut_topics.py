# SPDX-FileCopyrightText: 2026 The satvib authors
# SPDX-License-Identifier: Apache-2.0
"""The topics of one strut, heard cheaply: bytes are kept as they come, and read a few times a second.

Best effort: no writer ever waits for the page. Of samples and voltages every message is wanted, of states and models
the newest.
"""

import contextlib
import struct
from collections.abc import Callable, Iterable
from typing import Any

from rclpy.node import Node
from rclpy.qos import DurabilityPolicy, HistoryPolicy, QoSProfile, ReliabilityPolicy
from rclpy.serialization import deserialize_message
from rclpy.subscription import Subscription
from satvib_experiment.recording.cdr import acceleration_figures, sequence_and_figures

from satvib_bringup.watch.samples import Column
from satvib_bringup.watch.strut import WatchedStrut
from satvib_msgs.msg import (
    ControllerState,
    IirParameters,
    StrutAcceleration,
    StrutProgress,
    VcaVoltage,
)

# of a message, what no page shows
_HIDDEN = ('header', 'covariance')
_MOST = 1000  # messages between two looks


def latest(depth: int) -> QoSProfile:
    """Hear what comes, and let nobody wait."""
    return QoSProfile(
        history=HistoryPolicy.KEEP_LAST,
        depth=depth,
        reliability=ReliabilityPolicy.BEST_EFFORT,
        durability=DurabilityPolicy.VOLATILE,
    )


def _read_all(rows: Iterable[bytes], read: Callable[[bytes], Any]) -> list[Any]:
    """Read messages; those that are cut off, as a stranger's may be, are left out."""
    found = []
    for message in rows:
        with contextlib.suppress(struct.error):
            found.append(read(message))
    return found


def _voltage(message: bytes) -> tuple[Any, ...]:
    return sequence_and_figures(message, 1)


class StrutTopics:
    """The subscriptions of one strut.

    Args:
        node: that listens.
        strut: takes what is heard.

    Attributes:
        heard: messages that have come.
    """

    def __init__(self, node: Node, strut: WatchedStrut) -> None:
        self._node, self._strut = node, strut
        self._subscriptions: list[Subscription] = []  # without that of the progress
        self._many: dict[str, list[bytes]] = {}
        self._newest: dict[str, tuple[Any, bytes]] = {}
        self.has_progress = False
        self.heard = 0
        self._progress = self._hear_newest('progress', StrutProgress)

    @property
    def hears_samples(self) -> bool:
        """Whether `hear_samples` was called."""
        return 'acceleration' in self._many

    def hear_samples(self) -> None:
        """Hear everything."""
        for topic, kind in (('acceleration', StrutAcceleration), ('voltage', VcaVoltage)):
            self._subscriptions.append(self._hear_many(topic, kind))
        for topic, kind in (
            ('controller_state', ControllerState),
            ('identified_model', IirParameters),
        ):
            self._subscriptions.append(self._hear_newest(topic, kind))

    def collect(self) -> None:
        """Hand over what has come since the last call."""
        strut = self._strut
        if rows := self._many.get('acceleration'):
            samples = _read_all(rows, acceleration_figures)
            strut.take_accelerations([sample[:4] for sample in samples])
            # a sample says what the coil had before it
            applied = [(k - 1, volts) for k, *_, volts, state in samples if state and k > 0]
            strut.take_voltages(Column.APPLIED, applied)
            strut.applied = samples[-1][-1] if samples else strut.applied
            rows.clear()
        if rows := self._many.get('voltage'):
            strut.take_voltages(Column.ASKED, _read_all(rows, _voltage))
            rows.clear()
        newest, self._newest = self._newest, {}
        for topic, (kind, message) in newest.items():
            try:
                read = deserialize_message(message, kind)
            except (ValueError, RuntimeError):  # of a stranger
                continue
            if topic == 'progress':
                strut.take_progress(read.sequence, read.phase, read.upper_rms)
                continue
            figures = {
                name: getattr(read, name)
                for name in read.get_fields_and_field_types()
                if name not in _HIDDEN
            }
            (strut.take_state if topic == 'controller_state' else strut.take_model)(figures)

    def rest(self) -> None:
        """Hear no samples any more, until the strut speaks again."""
        for subscription in self._subscriptions:
            self._node.destroy_subscription(subscription)
        self._subscriptions.clear()
        self._many.clear()
        self.has_progress = False

    def _hear_many(self, topic: str, kind: Any) -> Subscription:
        rows = self._many[topic] = []

        def take(message: bytes) -> None:
            self.heard += 1
            if len(rows) < _MOST:
                rows.append(message)

        return self._subscribe(topic, kind, take, _MOST)

    def _hear_newest(self, topic: str, kind: Any) -> Subscription:
        def take(message: bytes) -> None:
            self.heard += 1
            self._newest[topic] = (kind, message)
            self.has_progress |= topic == 'progress'

        return self._subscribe(topic, kind, take, 1)

    def _subscribe(
        self, topic: str, kind: Any, take: Callable[[bytes], None], depth: int
    ) -> Subscription:
        name = f'/{self._strut.name}/{topic}'
        return self._node.create_subscription(kind, name, take, latest(depth), raw=True)
