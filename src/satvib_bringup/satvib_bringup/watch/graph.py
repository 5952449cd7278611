# SPDX-FileCopyrightText: 2026 The satvib authors
# SPDX-License-Identifier: Apache-2.0
"""What is known of a running graph: its struts, what its nodes say about themselves, and what people have asked for."""

import time
from collections import deque
from collections.abc import Mapping
from datetime import datetime
from typing import Any

from satvib_bringup.watch.strut import WatchedStrut

_LINES = 50
_GONE = 5.0  # s without a word, after which a node counts as gone


class WatchedGraph:
    """All graphs of a domain together.

    Attributes:
        struts: by namespace, in the order of their names.
        recording: folder that is being written; empty: none.
    """

    def __init__(self) -> None:
        self.struts: dict[str, WatchedStrut] = {}
        self.recording = ''
        self.armable = False
        self._schedules: dict[str, str] = {}
        self._nodes: dict[str, dict[str, Any]] = {}
        self._lines: deque[dict[str, str]] = deque(maxlen=_LINES)
        self._fresh: list[dict[str, str]] = []

    def strut(self, name: str) -> WatchedStrut:
        """The strut of a name, made when it is new."""
        if name not in self.struts:
            self.struts[name] = WatchedStrut(name)
            self.struts = dict(sorted(self.struts.items()))
        return self.struts[name]

    def take_schedule(self, topic: str, scenario: str) -> None:
        """Take the name of the scenario that runs."""
        self._schedules[topic] = scenario

    def take_status(self, name: str, level: int, text: str, figures: Mapping[str, str]) -> None:
        """Take what a node says on /diagnostics; level 0 well, 1 complaint, 2 fault, 3 not active."""
        self._nodes[name] = {
            'level': level, 'text': text, 'figures': dict(figures), 'heard': time.monotonic(),
        }  # fmt: skip

    def say(self, text: str, well: bool = True) -> None:
        """Add a line to what every page shows: who asked for what, and what came of it."""
        now = datetime.now().astimezone().strftime('%H:%M:%S')
        line = {'time': now, 'text': text, 'kind': 'well' if well else 'bad'}
        self._lines.append(line)
        self._fresh.append(line)

    def look(self) -> None:
        """Do what is due every second."""
        for strut in self.struts.values():
            strut.look()
        now = time.monotonic()
        for node in self._nodes.values():
            if now - node['heard'] > _GONE and node['level'] != 4:
                node.update(level=4, text='gone: has said nothing for 5 s')

    def news(self) -> dict[str, Any]:
        """What is new since the last call, for all pages alike."""
        lines, self._fresh = self._fresh, []
        return self._message([s.news() for s in self.struts.values()], lines)

    def whole(self) -> dict[str, Any]:
        """Everything up to the last `news`, for a page that has just been opened."""
        found = self._message([s.whole() for s in self.struts.values()], list(self._lines))
        return found | {'kind': 'whole'}

    def _message(self, struts: list[dict[str, Any]], lines: list[dict[str, str]]) -> dict[str, Any]:
        return {
            'kind': 'news',
            'struts': struts,
            'scenario': ', '.join(sorted({s for s in self._schedules.values() if s})),
            'nodes': [
                {'name': name, **{k: node[k] for k in ('level', 'text', 'figures')}}
                for name, node in sorted(self._nodes.items())
            ],
            'lines': lines,
            'recording': self.recording,
            'armable': self.armable,
        }
