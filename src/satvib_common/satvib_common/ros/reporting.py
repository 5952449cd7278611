# SPDX-FileCopyrightText: 2026 The satvib authors
# SPDX-License-Identifier: Apache-2.0
"""What a node says about itself: on /diagnostics once a second and when it finds others, and in the log what it awaits.

A node that waits for the same thing for five seconds says so in its log, and again every five seconds, with the full
name of the topic. Where that topic has no source but one of the same name elsewhere has, that one is named: most often
a node was started in another namespace than the rest of its graph.
"""

import time
from typing import TYPE_CHECKING, Any

from satvib_common.realtime import tidy_memory
from satvib_common.ros.diagnostics import READERS_OF, WRITERS_OF, Diagnostics
from satvib_common.ros.loop.rivals import too_many_writers

if TYPE_CHECKING:
    from satvib_common.ros.node import SatvibNode

_PERIOD = 1.0  # s
QUIET = 1.0  # s, without what comes with every sample, after which it is missed
# s and times: how often a young node looks whether it has found others
_LOOK, _LOOKS = 0.1, 300
# topics of the loop that have one writer
_SOLE = frozenset({'acceleration', 'voltage', 'identified_model', 'schedule', 'supervision'})
_SAY_EVERY = 5.0  # s, to the nearest report


class Reporting:
    """The reports of one node while it is configured.

    Args:
        node: it.

    Attributes:
        diagnostics: where they go.
    """

    def __init__(self, node: 'SatvibNode[Any]') -> None:
        self._node = node
        self.diagnostics = Diagnostics(node)
        self._before = self._rivals_before = self._rivals_now = ''
        self._since = self._said = 0.0
        self._found: dict[str, object] = {}
        self._looks = 0
        node.every(_PERIOD, self._report)
        self._looking = node.every(_LOOK, self._look_around)

    def connections(self) -> dict[str, Any]:
        """Count the readers and writers that are connected; the graph lists them before they are."""
        node = self._node
        found = {READERS_OF + w.topic_name: w.get_subscription_count() for w in node.writers()}
        return found | {WRITERS_OF + r.topic_name: r.get_publisher_count() for r in node.readers()}

    def awaited(self) -> str:
        """What the node waits for; empty: for nothing."""
        return self._node.awaits() if self._node.active else ''

    def rivals(self) -> str:
        """Who else writes a topic of the loop that this node reads or writes, at two reports; empty: nobody."""
        found = self._rivals_now
        return found if found == self._rivals_before else ''

    def _look_for_rivals(self) -> None:
        node = self._node
        topics = [r.topic_name for r in node.readers()] + [w.topic_name for w in node.writers()]
        sole = [topic for topic in topics if topic.rpartition('/')[2] in _SOLE]
        before = self.rivals()
        self._rivals_before = self._rivals_now
        self._rivals_now = too_many_writers(node, *dict.fromkeys(sole)) if node.active else ''
        if (found := self.rivals()) and found != before:
            # no error: a node that was killed stays in the graph for some seconds
            node.get_logger().warning(found)

    def _report(self) -> None:
        self._look_for_rivals()
        self._node.report_state()
        self._await(self.awaited())
        tidy_memory()

    def _await(self, what: str) -> None:
        now = time.monotonic()
        if what != self._before:
            self._since = self._said = now
        self._before = what
        if what and now - self._said > _SAY_EVERY - 0.5 * _PERIOD:
            self._said = now
            self._node.get_logger().warning(f'waits for {what} ({now - self._since:.0f} s so far)')

    def _look_around(self) -> None:
        """Report at once when others have been found: a run begins when everybody has."""
        self._looks += 1
        found = self._found
        if self._looks < _LOOKS:
            found = self.connections() | {'': self.diagnostics.readers()}
        if found != self._found:
            self._found = found
            self._node.report_state()
        elif self._looks == _LOOKS:
            self._looking.cancel()


def source_of(node: Any, topic: str) -> str:
    """Give the full name of a topic that is awaited, and where it has no source, those of its name that have one."""
    name = node.resolve_topic_name(topic)
    if node.count_publishers(name):
        return str(name)
    last = name.rpartition('/')[2]
    others = [
        other
        for other, _ in node.get_topic_names_and_types()
        if other.rpartition('/')[2] == last and node.count_publishers(other)
    ]
    if not others:
        return f'{name}, on which no node publishes; is the namespace right?'
    return f'{name}, on which no node publishes; there is {", ".join(sorted(others)[:4])}'
