# SPDX-FileCopyrightText: 2026 The satvib authors
# SPDX-License-Identifier: Apache-2.0
"""What a node publishes with and listens with: the middleware, and the exchange where nodes share a process."""

import time
from collections.abc import Callable
from typing import Any

from rclpy.impl.implementation_singleton import rclpy_implementation
from rclpy.node import Node
from rclpy.qos import DurabilityPolicy, QoSProfile
from rclpy.qos_overriding_options import QoSOverridingOptions
from rclpy.subscription import Subscription

from satvib_common.errors import RunError
from satvib_common.ros.delivery.exchange import Exchange, Reader
from satvib_common.ros.delivery.wire import UnreadableError, Wire, wire_of
from satvib_common.ros.qos import overridable

# s, with a reader that takes nothing; one that has ended without a word is forgotten after 20 s
_PATIENCE = 30.0
_AT_ONCE = 0.02  # s; an error that comes sooner is no lack of room


def _options(node: Node, topic: str) -> QoSOverridingOptions | None:
    """What people may change of the next subscription to a topic.

    The parameters of an earlier subscription to it hold what that one asked for, and would change the next one to it.
    """
    begin = f'qos_overrides.{topic}.subscription.'
    given = any(name.startswith(begin) for name in getattr(node, '_parameter_overrides', {}))
    return overridable() if given or not node.has_parameter(f'{begin}durability') else None


class Output:
    """A publisher that sends nothing that nobody wants.

    Args:
        publisher: of the middleware; one of a managed node publishes while it is activated.
        exchange: of this process; None: the node is alone in it.
        spared: nobody waits for these messages, so that they go out only while they are read.
        given_up: of a writer that overwrites nothing (`qos.offered`, `paced`), and so waits for a reader that is as
            far behind as it keeps: whether it need not wait any longer. In lockstep nothing else holds the loop back
            when a recorder does not keep up. None: it waits for nobody.
    """

    def __init__(
        self, publisher: Any, exchange: Exchange | None, spared: bool,
        given_up: Callable[[], bool] | None = None,
    ) -> None:  # fmt: skip
        self.publisher: Any = publisher
        self.topic_name: str = publisher.topic_name
        self._exchange = exchange
        self._wire = wire_of(publisher.msg_type)
        self._topic = exchange.topic(self.topic_name) if exchange else None
        if self._topic is not None:
            self._topic.writers += 1
        self._given_up = given_up
        self._spared = spared or (
            exchange is not None and exchange.closed and publisher.qos_profile.depth > 1
        )

    def publish(self, message: Any) -> None:
        """Publish to the readers in this process and to all others.

        Args:
            message: of the kind, or anything with the same attributes where that kind has a `wire`.
        """
        publisher, topic = self.publisher, self._topic
        sent = message
        local = topic is not None and topic.readers and getattr(publisher, 'is_activated', True)
        remote = not self._spared or publisher.get_subscription_count() > 0
        if self._wire is not None and (local or remote):
            sent = self._wire.pack(message)
        if local:
            assert topic is not None
            assert self._exchange is not None
            sent = self._exchange.send(topic, sent) or sent
        if remote:
            if self._given_up is None:
                publisher.publish(sent)
            else:
                self._publish_in_pace(sent, self._given_up)

    def _publish_in_pace(self, message: Any, given_up: Callable[[], bool]) -> None:
        """Publish as soon as the readers have made room; the middleware waits for 0.1 s each time.

        Raises:
            RunError: they do not.
            RCLError: the middleware refuses for another reason.
        """
        began = tried = time.monotonic()
        while True:
            try:
                self.publisher.publish(message)
            except rclpy_implementation.RCLError:
                now = time.monotonic()
                if now - tried < _AT_ONCE:
                    raise
                if given_up():
                    return
                if now - began > _PATIENCE:
                    raise RunError(
                        f'{self.topic_name}: a reader has taken nothing for {_PATIENCE:g} s, and in '
                        'lockstep all wait for every reader; end that reader'
                    ) from None
                tried = now
            else:
                return

    def is_read(self) -> bool:
        """Whether it is worth while to fill in a message."""
        if not self._spared or (self._topic is not None and self._topic.readers):
            return True
        return bool(self.publisher.get_subscription_count() > 0)

    def get_subscription_count(self) -> int:
        """How many readers in other processes are connected."""
        return int(self.publisher.get_subscription_count())

    def wait_for_all_acked(self, timeout: Any) -> bool:
        """Wait until every reader in another process has what was published."""
        return bool(self.publisher.wait_for_all_acked(timeout))

    def close(self) -> None:
        """The writer is gone; its publisher is destroyed by its node."""
        if self._topic is not None:
            self._topic.writers -= 1


class Input:
    """A subscription: of the middleware, shared in this process, or to a writer of this process alone.

    Args:
        node: that listens.
        exchange: of this process; None: the node is alone in it.
        kind: of the messages.
        topic: name.
        call: takes a message.
        qos: as wanted of the middleware.
        rank: of the node.
        raw: serialized messages. Else those of a kind that has a `wire` come as its records.
    """

    def __init__(
        self, node: Node, exchange: Exchange | None, kind: Any, topic: str,
        call: Callable[[Any], None], qos: QoSProfile, rank: int, raw: bool = False,
    ) -> None:  # fmt: skip
        self.topic_name: str = node.resolve_topic_name(topic)
        self._node, self._exchange = node, exchange
        self.subscription: Subscription | None = None
        self._reader: Reader | None = None
        self._open = True
        taken, wire = call, None if raw else wire_of(kind)
        if wire is not None:
            raw, taken = True, self._reading(wire, call)
        # the executor takes all messages that were there when it looked, also when the first of them ends the reader
        taken = self._while_open(taken)

        def subscribe(take: Callable[[Any], None]) -> Subscription:
            options = _options(node, self.topic_name)
            return node.create_subscription(
                kind, topic, take, qos, qos_overriding_options=options, raw=raw
            )

        if exchange is None:
            self.subscription = subscribe(taken)
            return
        whole = qos.durability == DurabilityPolicy.TRANSIENT_LOCAL
        local = exchange.topic(self.topic_name)
        self._reader = Reader(taken, rank, raw)
        if local.writers:
            exchange.attach(self.topic_name, self._reader, whole)
        elif exchange.founding and (local.subscription is None or local.is_raw == raw):
            exchange.attach(self.topic_name, self._reader)
            if local.subscription is None:
                local.node, local.is_raw = node, raw
                local.subscription = subscribe(lambda m: exchange.pass_on(local, m))
        else:  # the past of the topic comes to new subscriptions only
            self._reader = None
            self.subscription = subscribe(taken)

    def _while_open(self, call: Callable[[Any], None]) -> Callable[[Any], None]:
        def taken(message: Any) -> None:
            if self._open:
                call(message)

        return taken

    def _reading(self, wire: Wire, call: Callable[[Any], None]) -> Callable[[bytes], None]:
        """Give what reads the bytes of a message and hands it on; what cannot be read changes nothing."""
        unpack, topic, logger = wire.unpack, self.topic_name, self._node.get_logger()

        def taken(data: bytes) -> None:
            try:
                message = unpack(data)
            except UnreadableError as error:
                # a flood is one line for each second
                logger.error(f'refused: {topic}: {error}', throttle_duration_sec=1.0)
                return
            call(message)

        return taken

    def get_publisher_count(self) -> int:
        """How many writers are connected."""
        if self.subscription is not None:
            return self.subscription.get_publisher_count()
        assert self._exchange is not None
        local = self._exchange.topic(self.topic_name)
        if local.writers:
            return local.writers
        return int(local.subscription.get_publisher_count()) if local.subscription else 0

    def is_local(self) -> bool:
        """Whether it hears a writer of this process."""
        return (
            self.subscription is None
            and self._exchange is not None
            and bool(self._exchange.topic(self.topic_name).writers)
        )

    def close(self) -> None:
        """Listen no more; what has come and was not taken yet is left out."""
        self._open = False
        if self.subscription is not None:
            self._node.destroy_subscription(self.subscription)
        elif self._exchange is not None and self._reader is not None:
            self._exchange.detach(self.topic_name, self._reader)
            local = self._exchange.topic(self.topic_name)
            if local.subscription is not None and not local.readers:
                local.node.destroy_subscription(local.subscription)
                local.subscription = None
