# SPDX-FileCopyrightText: 2026 The satvib authors
# SPDX-License-Identifier: Apache-2.0
"""Whether a controller hears two plants or two identifiers: then it latches 0 V, and its reason names them.

Two names in the graph prove nothing, for a node that was killed stays there for some seconds. Two sources that speak in
turns are found by the order of their messages (`satvib_common.sequence.Rivals`).
"""

from collections.abc import Sequence
from typing import Any

from satvib_common.ros.loop.rivals import too_many_writers, two_sources, writers_of
from satvib_common.sequence import Rivals
from satvib_common.struts.applied import TEXTS, Applied

from satvib_control.laws.reasons import reason

_LATCHED = TEXTS[Applied.LATCHED]


class SourceWatch:
    """The sources of one controller node.

    Args:
        node: it, with its `core`.
        names: of the struts, as prefixes of their topics.
    """

    def __init__(self, node: Any, names: Sequence[str]) -> None:
        self._node, self._names = node, names
        self.reset()

    def reset(self) -> None:
        """Begin again."""
        self._samples, self._models = Rivals(), Rivals()
        self._newest = -1

    def see_sample(self, odd: bool, topic: str) -> None:
        """Take a sample of a topic, and whether it does not follow those before."""
        if self._samples.saw(odd):
            self._latch('samples', topic)

    def see_model(self, sequence: int, topic: str) -> None:
        """Take a model of a topic, by the sample that it includes last."""
        odd, self._newest = sequence <= self._newest, sequence
        if self._models.saw(odd):
            self._latch('models', topic)

    def latched(self) -> str:
        """Say that 0 V is latched, as `with_source`, and who else answers for a strut, which latches it."""
        rivals = too_many_writers(self._node, *(f'{name}voltage' for name in self._names))
        return '; '.join(filter(None, (self.with_source(_LATCHED), rivals)))

    def with_source(self, complaint: str) -> str:
        """Name the source that has latched 0 V, and its service that ends that, in a complaint that says so."""
        if _LATCHED not in complaint:
            return complaint
        sources = writers_of(self._node, f'{self._names[0]}acceleration')
        by, resets = (' or '.join(f'{s}{end}' for s in sources) for end in ('', '/reset'))
        what = f'0 V: latched by {by}, which says why on /diagnostics, until {resets} is called'
        return complaint.replace(_LATCHED, what) if sources else complaint

    def _latch(self, what: str, topic: str) -> None:
        found = two_sources(
            self._node,
            topic,
            f'two sources of {what}, end one of them',
            f'{what} as of two sources',
        )
        why = f'fault: {found}; then call ~/reset'
        self._node.core.stop(why=reason(why))
        self._node.get_logger().error(f'0 V: {why}')
