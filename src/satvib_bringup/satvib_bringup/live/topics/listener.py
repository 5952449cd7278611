# SPDX-FileCopyrightText: 2026 The satvib authors
# SPDX-License-Identifier: Apache-2.0
"""A node that only listens: which topics there are, how fast they are, and what they say."""

import time
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass
from importlib import import_module
from typing import Any

from rclpy.qos import QoSProfile, ReliabilityPolicy
from satvib_common.errors import SatvibError
from satvib_common.files.suggestions import nearest
from satvib_common.ros.loop.rivals import node_of
from satvib_common.ros.qos import wanted

from satvib_bringup.live.topics.visitor import Visitor

_SLICE = 0.05  # s
_PATIENCE = 5.0  # s, for a topic that is named
_OURS = ('satvib_msgs/', 'diagnostic_msgs/', 'rosgraph_msgs/Clock')
_SCHEDULE = 'satvib_msgs/msg/Schedule'
_OWN = 'topics'


@dataclass(frozen=True)
class TopicRow:
    """One topic.

    Attributes:
        name: absolute.
        kind: type of its messages.
        writers, readers: names of the nodes.
    """

    name: str
    kind: str
    writers: tuple[str, ...]
    readers: tuple[str, ...]


@dataclass
class Rate:
    """What a topic did while it was listened to.

    Attributes:
        messages, size: how many, and their bytes.
        first, last: s of the steady clock, when the first and the last one came.
        longest: s, the longest gap between two.
    """

    messages: int = 0
    size: int = 0
    first: float = 0.0
    last: float = 0.0
    longest: float = 0.0

    def take(self, message: bytes) -> None:
        """Count a message."""
        now = time.monotonic()
        if self.messages:
            self.longest = max(self.longest, now - self.last)
        else:
            self.first = now
        self.messages, self.size, self.last = self.messages + 1, self.size + len(message), now

    @property
    def hertz(self) -> float:
        """Messages per second between the first and the last; 0 with fewer than two."""
        return (self.messages - 1) / (self.last - self.first) if self.messages > 1 else 0.0


class Listener(Visitor):
    """A context manager with a node in a context of its own."""

    def __init__(self) -> None:
        super().__init__(_OWN)

    def topics(self, patience: float = 2.0, everything: bool = False) -> list[TopicRow]:
        """Give the topics of satvib that anybody writes or reads, by name.

        Args:
            patience: s, how long to look; the look ends early when nothing new has appeared for half a second.
            everything: other topics too.
        """
        deadline, found, quiet = time.monotonic() + patience, set[str](), time.monotonic()
        while time.monotonic() < deadline and not (found and time.monotonic() > quiet + 0.5):
            self._spin(_SLICE)
            names = {row.name for row in self._rows(everything)}
            if names != found:
                found, quiet = names, time.monotonic()
        return self._rows(everything)

    def rates(self, names: Sequence[str], seconds: float) -> dict[str, Rate]:
        """Listen for some time; gives a rate for each topic, of all topics of satvib that have a writer without names.

        Raises:
            SatvibError: there is no such topic.
        """
        rows = self._chosen(names)
        found = {row.name: Rate() for row in rows}
        for row in rows:
            self._subscribe(row, found[row.name].take, raw=True)
        deadline = time.monotonic() + seconds
        while (left := deadline - time.monotonic()) > 0.0:
            self._spin(min(left, _SLICE))
        return found

    def messages(self, name: str, count: int, patience: float) -> Iterator[Any]:
        """Give the messages of a topic as they come.

        Args:
            name: of the topic.
            count: how many; 0: without end.
            patience: s, how long to wait for the next one; 0: for ever.

        Raises:
            SatvibError: there is no such topic, or nothing comes.
        """
        waiting: list[Any] = []
        (row,) = self._chosen([name])
        self._subscribe(row, waiting.append)
        given, since = 0, time.monotonic()
        while not count or given < count:
            if waiting:
                yield waiting.pop(0)
                given, since = given + 1, time.monotonic()
                continue
            if patience and time.monotonic() > since + patience:
                raise SatvibError(
                    f'{row.name}: nothing came within {patience:g} s; it is written by '
                    f'{", ".join(row.writers) or "nobody"}'
                )
            self._spin(_SLICE)

    def _chosen(self, names: Sequence[str]) -> list[TopicRow]:
        """The topics of these names, for which it waits; without names all that are written."""
        if not names:
            return [row for row in self.topics() if row.writers]
        wanted_names = [name if name.startswith('/') else f'/{name}' for name in names]
        deadline = time.monotonic() + _PATIENCE
        while True:
            known = {row.name: row for row in self._rows(everything=True)}
            missing = [
                name for name in wanted_names if name not in known or not known[name].writers
            ]
            if not missing:
                return [known[name] for name in wanted_names]
            if time.monotonic() > deadline:
                break
            self._spin(_SLICE)
        for name in missing:
            if name not in known:
                raise SatvibError(f'{name}: no such topic here; {nearest(name, sorted(known))}')
        return [known[name] for name in wanted_names]

    def _subscribe(self, row: TopicRow, take: Callable[[Any], None], raw: bool = False) -> None:
        infos = self._node.get_publishers_info_by_topic(row.name)
        qos = wanted(whole=row.kind == _SCHEDULE)
        if any(i.qos_profile.reliability == ReliabilityPolicy.BEST_EFFORT for i in infos):
            qos = QoSProfile(depth=100, reliability=ReliabilityPolicy.BEST_EFFORT)
        self._node.create_subscription(_class_of(row.kind), row.name, take, qos, raw=raw)

    def _rows(self, everything: bool = False) -> list[TopicRow]:
        rows = []
        for name, kinds in self._node.get_topic_names_and_types():
            if not everything and not kinds[0].startswith(_OURS):
                continue
            ends = [
                tuple(sorted(node_of(info) for info in infos if info.node_name != _OWN))
                for infos in (
                    self._node.get_publishers_info_by_topic(name),
                    self._node.get_subscriptions_info_by_topic(name),
                )
            ]  # fmt: skip
            rows.append(TopicRow(name, kinds[0], *ends))
        return sorted(rows, key=lambda row: row.name)


def _class_of(kind: str) -> Any:
    """Class of a message.

    Raises:
        SatvibError: its package is not in this environment.
    """
    package, _, name = kind.partition('/msg/')
    try:
        return getattr(import_module(f'{package}.msg'), name)
    except (ImportError, AttributeError):
        raise SatvibError(f'{kind}: this message is not in this environment') from None
