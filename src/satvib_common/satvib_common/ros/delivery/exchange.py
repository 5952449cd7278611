# SPDX-FileCopyrightText: 2026 The satvib authors
# SPDX-License-Identifier: Apache-2.0
"""Messages between the nodes of one process: directly, in order, without the middleware.

A process with several nodes has one exchange. What a node publishes goes to the readers in the same process as a copy,
because writers refill their messages, and to the middleware for everybody else. Readers of one topic whose writer is
elsewhere share one subscription.

Deliveries wait in queues by rank: plant and controllers first, then identifiers, then the recorder. The order within a
rank is the order of publication. A reader whose topic has a writer in this process hears that writer only.
"""

import time
from array import array
from collections import deque
from collections.abc import Callable
from typing import Any

from rclpy.serialization import serialize_message

RANKS = 3
_SLICE = 0.002  # s, for the first rank, before the others have their turn
_PLAIN = frozenset({int, float, bool, str})
_BEHIND = 200  # deliveries; more than that do not wait for the first rank any longer


def copy_of(message: Any) -> Any:
    """Copy a message with all that it holds."""
    kind = type(message)
    made = object.__new__(kind)
    for slot in kind.__slots__:
        value = getattr(message, slot)
        if type(value) not in _PLAIN:
            if hasattr(value, '__slots__'):
                value = copy_of(value)
            elif isinstance(value, array):
                value = value[:]
            elif isinstance(value, list):
                value = [copy_of(v) if hasattr(v, '__slots__') else v for v in value]
        setattr(made, slot, value)
    return made


class Reader:
    """Who listens in this process.

    Args:
        call: takes the message.
        rank: when its turn comes, from 0.
        raw: it wants the serialized message.
    """

    def __init__(self, call: Callable[[Any], None], rank: int, raw: bool) -> None:
        self.call, self.rank, self.raw = call, rank, raw
        self.listens = True


class LocalTopic:
    """A topic as this process knows it.

    Attributes:
        readers: in this process, the first rank first.
        writers: how many there are in this process.
        last: the newest message; only of topics with readers.
    """

    def __init__(self) -> None:
        self.readers: list[Reader] = []
        self.writers = 0
        self.last: Any = None
        self.subscription: Any = None
        self.node: Any = None
        self.is_raw = False


class Exchange:
    """The messages of one process.

    Args:
        closed: all nodes of the graph are in this process; outsiders get what they ask for, but nobody waits for them.
    """

    def __init__(self, closed: bool = False) -> None:
        self.closed = closed
        self.founding = (
            True  # nothing has been received yet, so that readers can share a subscription
        )
        self.wake: Callable[[], None] = lambda: None
        self._topics: dict[str, LocalTopic] = {}
        self._queues: list[deque[tuple[Reader, Any]]] = [deque() for _ in range(RANKS)]
        self._delivering = False

    def topic(self, name: str) -> LocalTopic:
        """The topic of a name, made when it is new."""
        return self._topics.setdefault(name, LocalTopic())

    def attach(self, name: str, reader: Reader, whole: bool = False) -> None:
        """Let a reader hear what is published in this process; `whole`: also the newest message of before."""
        topic = self.topic(name)
        topic.readers.append(reader)
        topic.readers.sort(key=lambda r: r.rank)
        if whole and topic.last is not None:
            self._put(reader, topic.last)

    def detach(self, name: str, reader: Reader) -> None:
        """Let a reader hear nothing more."""
        reader.listens = False
        topic = self.topic(name)
        if reader in topic.readers:
            topic.readers.remove(reader)

    def send(self, topic: LocalTopic, message: Any) -> bytes | None:
        """Hand a message to the readers in this process; gives it serialized if one of them wanted it so.

        A message that is serialized already is for those who want it so.
        """
        copy: Any = None
        text: bytes | None = None
        for reader in topic.readers:
            if reader.raw:
                if text is None:
                    text = message if isinstance(message, bytes) else serialize_message(message)
                self._put(reader, text)
            else:
                copy = copy_of(message) if copy is None else copy
                self._put(reader, copy)
        topic.last = text if isinstance(message, bytes) else copy
        return text

    def pass_on(self, topic: LocalTopic, message: Any) -> None:
        """Hand on what has come over the middleware; it is new every time, so it needs no copy."""
        for reader in topic.readers:
            self._put(reader, message)
        self.first()

    def _put(self, reader: Reader, message: Any) -> None:
        self._queues[reader.rank].append((reader, message))
        if reader.rank:
            self.wake()

    def waits(self) -> bool:
        """Whether any delivery waits."""
        return any(self._queues)

    def first(self) -> None:
        """Deliver what waits for the first rank, now; a delivery may lead to others."""
        if self._delivering or not self._queues[0]:
            return
        self._deliver(self._queues[0], time.monotonic() + _SLICE)
        if self._queues[0]:
            self.wake()

    def work(self, until: float) -> None:
        """Deliver what waits, rank by rank, until nothing is left or it is `until`, s of the steady clock."""
        first, lower = self._queues[0], self._queues[1:]
        while True:
            now = time.monotonic()
            self._deliver(first, now + _SLICE)
            # the longest of those that are behind, else the first that waits
            behind = max(lower, key=len)
            queue = behind if len(behind) > _BEHIND else next((q for q in lower if q), None)
            if queue is None and not first:
                return
            if queue is not None:
                # one at a time, because a sample may come meanwhile; a long queue does not wait any longer
                self._delivering = (
                    True  # what these publish for the first rank has its turn afterwards
                )
                try:
                    for _ in range(max(len(queue) - _BEHIND, 1)):
                        self._hand_over(queue)
                finally:
                    self._delivering = False
            if time.monotonic() >= until:
                return

    def _deliver(self, queue: deque[tuple[Reader, Any]], until: float) -> None:
        self._delivering = True
        try:
            while queue:
                self._hand_over(queue)
                if time.monotonic() >= until:
                    return
        finally:
            self._delivering = False

    @staticmethod
    def _hand_over(queue: deque[tuple[Reader, Any]]) -> None:
        reader, message = queue.popleft()
        if reader.listens:
            reader.call(message)
