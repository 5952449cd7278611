# SPDX-FileCopyrightText: 2026 The satvib authors
# SPDX-License-Identifier: Apache-2.0
"""The node `recorder`: writes the schedule, every topic of every strut and /diagnostics to a bag.

Messages are taken as the bytes that came over the wire. A message of a strut is filed under the stamp of its sample,
which in lockstep is the time of the simulation; the others under the newest stamp so far. Per topic the sequence is
followed, and what was lost is reported.
"""

import json
import time
from collections.abc import Callable
from datetime import datetime
from functools import partial
from importlib import import_module
from pathlib import Path

from satvib_common.ros.delivery.wire import UnreadableError, checker_of
from satvib_common.ros.main import run_node
from satvib_common.ros.node import SatvibNode
from satvib_common.ros.qos import wanted
from satvib_common.ros.reporting import source_of
from satvib_experiment.recording.cdr import stamp_and_sequence
from satvib_experiment.recording.topics import SHARED_TOPICS, STRUT_TOPICS

from satvib_bringup.recorder.bag_sink import BagSink, Channel
from satvib_bringup.recorder.topic_recorder import RecorderParameters, Topic
from satvib_msgs.msg import Schedule

_GATHER = 0.02  # s


class RecorderNode(SatvibNode[RecorderParameters]):
    """Records the graph."""

    rank = 2

    def __init__(self) -> None:
        super().__init__('recorder', RecorderParameters)

    def configure(self) -> None:
        """Open the bag."""
        p = self.parameters
        stamp = datetime.now().astimezone().strftime('%Y%m%d-%H%M%S')
        folder = Path(p.folder or f'satvib-{stamp}')
        self.sink = BagSink(folder, dict(zip(p.custom_keys, p.custom_values, strict=True)))
        self.topics: dict[str, Topic] = {}
        self.newest: int | None = None
        self.early: list[tuple[Channel, bytes]] = []
        self.every(0.5, self.sink.check)

    def activate(self) -> None:
        """Listen to everything."""
        for name, kind in SHARED_TOPICS.items():
            # other people's nodes talk on /diagnostics too, and offer less
            self._record(name, kind, is_sampled=False, whole=not name.startswith('/'))
        for strut in self.parameters.struts:
            self._record_strut(strut)
        if not self.parameters.struts:
            self.listen_to(Schedule, 'schedule', self._on_schedule, wanted(whole=True))

    def deactivate(self) -> None:
        """Close the bag and report what is in it."""
        for channel, message in self.early:
            self.sink.put(channel, self.newest or time.time_ns(), message)
        self.sink.close()
        report = {topic.name: topic.report() for topic in self.topics.values()}
        if self.parameters.report:
            path = Path(self.parameters.report)
            path.write_text(json.dumps(report, indent=2) + '\n', encoding='utf-8')
        count = sum(topic.count for topic in self.topics.values())
        if awaited := self.awaits():
            self.get_logger().warning(
                f'no message of a strut is in the bag; it waited for {awaited}'
            )
        self.get_logger().info(f'{count} messages of {len(report)} topics in {self.sink.folder}')

    def pause(self) -> float:
        """No node waits for the recorder, and writers keep the samples of a second."""
        return _GATHER

    def sources_left(self) -> bool:
        """Whether any strut still speaks; this node itself speaks on /diagnostics."""
        return any(
            self.count_publishers(topic.name) > 0
            for topic in self.topics.values()
            if topic.is_sampled
        )

    def diagnose(self) -> tuple[str, dict[str, object]]:
        """Give the counts."""
        count = sum(topic.count for topic in self.topics.values())
        return '', {'messages': count, 'written': self.sink.written}

    def awaits(self) -> str:
        """Say that there is nothing to record yet."""
        sampled = [name for name, topic in self.topics.items() if topic.is_sampled]
        if not sampled:
            where = source_of(self, 'schedule')
            return f'the schedule, for the names of the struts, on {where} (or give the parameter struts)'
        if self.newest is not None:
            return ''
        return f'messages of the struts, as on {source_of(self, sampled[0])}'

    def _on_schedule(self, message: Schedule) -> None:
        for strut in message.struts:
            self._record_strut(strut)

    def _record_strut(self, strut_name: str) -> None:
        for name, kind in STRUT_TOPICS.items():
            if self.resolve_topic_name(f'{strut_name}/{name}') not in self.topics:
                self._record(f'{strut_name}/{name}', kind, is_sampled=True, whole=True)

    def _record(self, name: str, kind: str, is_sampled: bool, whole: bool) -> None:
        package, _, short = kind.partition('/msg/')
        topic = Topic(self.resolve_topic_name(name), kind, is_sampled)
        self.topics[topic.name] = topic
        message_class = getattr(import_module(f'{package}.msg'), short)
        take = partial(self._take, topic, checker_of(message_class))
        self.listen_to(message_class, name, take, wanted(whole, self.parameters.depth), raw=True)

    def _take(self, topic: Topic, check: Callable[[bytes], None], message: bytes) -> None:
        try:
            check(message)
        except UnreadableError as error:  # in the bag it would stop everybody who reads that
            self.get_logger().error(f'refused: {topic.name}: {error}', throttle_duration_sec=1.0)
            return
        (self._take_sampled if topic.is_sampled else self._take_other)(topic, message)

    def _take_sampled(self, topic: Topic, message: bytes) -> None:
        stamp, sequence = stamp_and_sequence(message)
        topic.saw(sequence)
        self.sink.put(topic.channel or self._open(topic), stamp, message)
        if self.newest is None or stamp > self.newest:
            if self.newest is None:
                for waiting, early in self.early:
                    self.sink.put(waiting, stamp, early)
                self.early.clear()
            self.newest = stamp

    def _take_other(self, topic: Topic, message: bytes) -> None:
        topic.count += 1
        channel = topic.channel or self._open(topic)
        if self.newest is None:
            self.early.append((channel, message))
        else:
            self.sink.put(channel, self.newest, message)

    def _open(self, topic: Topic) -> Channel:
        infos = self.get_publishers_info_by_topic(topic.name)
        qos = infos[0].qos_profile if infos else wanted(whole=True)
        return topic.open(qos.reliability.name, qos.durability.name)


def main() -> None:
    """Run the node."""
    run_node(RecorderNode)


if __name__ == '__main__':
    main()
