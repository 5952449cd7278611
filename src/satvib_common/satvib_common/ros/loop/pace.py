# SPDX-FileCopyrightText: 2026 The satvib authors
# SPDX-License-Identifier: Apache-2.0
"""Follows the pace of the samples: whether a node is in lockstep is said by their source, not by its own parameter.

`plant_sim` and `daq_bridge` say with each sample whether the samples follow the clock or wait for the voltages. The
parameter `lockstep` of a node counts until the first sample, and for sources that do not say it.

A reader in real time begins with the present sample. In lockstep that one may have been published before the reader was
found, and no other comes before it is answered. So a node that hears nothing, although there is a source, listens
again and asks for what was published before.
"""

import time
from collections.abc import Callable
from typing import Any

from rclpy.qos import DurabilityPolicy, QoSProfile

from satvib_common.ros.delivery.endpoints import Input
from satvib_common.ros.node import SatvibNode
from satvib_common.ros.qos import wanted
from satvib_common.struts.applied import Pace

# s and sample periods, whichever is more, without a sample of a source that is there
_SILENCE, _PERIODS = 0.5, 5.0
_PATIENCE = 3.0  # s, the same while samples are not expected
_KNOWN = {int(Pace.CLOCK), int(Pace.LOCKSTEP)}
_WORDS = {True: 'in lockstep', False: 'by the clock'}


class PaceFollower:
    """Sets `in_lockstep` of a node.

    Args:
        node: it.
        topic: of samples of one strut.
        listen: makes the subscriptions of the loop, with a QoS, and gives them; those of before are ended after that.
        changed: called when `in_lockstep` is another.
        expected: whether samples should come now: there is a schedule.

    Attributes:
        whole: the subscriptions of now get what was published before they came.
    """

    def __init__(
        self,
        node: SatvibNode[Any],
        topic: str,
        listen: Callable[[QoSProfile], list[Input]],
        changed: Callable[[], None],
        expected: Callable[[], bool],
    ) -> None:
        self._node, self._topic = node, node.resolve_topic_name(topic)
        self._listen, self._changed, self._expected = listen, changed, expected
        self._longest = max(_SILENCE, _PERIODS / node.parameters.sample_rate)
        self._pace = int(Pace.UNKNOWN)
        self._heard = False
        self._silent_since = 0.0
        self.whole = self._on = False
        self._inputs: list[Input] = []
        node.every(_SILENCE / 2.0, self._look)

    def begin(self) -> None:
        """Listen, as the node is paced now."""
        self._pace, self._heard = int(Pace.UNKNOWN), False
        self._inputs, self._on = [], True
        self._listen_again(self._node.in_lockstep)

    def end(self) -> None:
        """The node has ended its subscriptions."""
        self._inputs, self._on = [], False

    def see(self, pace: int, sequence: int) -> bool:
        """Take the pace and the number of a sample; False: leave it out.

        It is of another source, or the subscriptions were made again. A source keeps its pace, so samples of another
        pace are left out until those of this one have ceased.
        """
        if pace in {self._pace, Pace.UNKNOWN}:
            self._heard = True
            return True
        if self._pace != Pace.UNKNOWN or pace not in _KNOWN:
            return False
        self._heard, self._pace = True, pace
        node, lockstep = self._node, pace == Pace.LOCKSTEP
        if lockstep != node.in_lockstep:
            node.in_lockstep = lockstep
            node.get_logger().info(
                f'the samples come {_WORDS[lockstep]}, and so this node works; its parameter lockstep is '
                f'{str(node.parameters.lockstep).lower()}'
            )
            self._changed()
        if sequence == 0 or lockstep == self.whole:
            return True
        self._listen_again(lockstep)
        return False

    def _listen_again(self, whole: bool) -> None:
        self.whole = whole
        self._silent_since = time.monotonic()
        before, self._inputs = self._inputs, self._listen(wanted(whole=whole))
        for reader in before:
            self._node.forget(reader)

    def _has_past(self) -> bool:
        """Whether there are sources, and all of them keep what they have published."""
        infos = self._node.get_publishers_info_by_topic(self._topic)
        kept = DurabilityPolicy.TRANSIENT_LOCAL
        return bool(infos) and all(info.qos_profile.durability == kept for info in infos)

    def _look(self) -> None:
        """Find out whether there is a source that is not heard."""
        heard, self._heard = self._heard, False
        now = time.monotonic()
        if heard or not (self._on and self._node.active and self._has_past()):
            self._silent_since = now
            if not heard:
                self._pace = int(Pace.UNKNOWN)  # another source may be another
        elif self._pace == Pace.UNKNOWN and not self.whole:
            longest = self._longest if self._expected() else _PATIENCE + self._longest
            if now - self._silent_since > longest:
                self._listen_again(True)
