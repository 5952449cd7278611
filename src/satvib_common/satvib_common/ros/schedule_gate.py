# SPDX-FileCopyrightText: 2026 The satvib authors
# SPDX-License-Identifier: Apache-2.0
"""Which schedules a node takes: one for a run, and nothing from a stranger while the run is on.

| schedule | before a run | while a run is on |
|---|---|---|
| malformed (unknown phases, disorder, absurd numbers) | refused | refused |
| another rate or other struts than the node has | `SatvibError`, a wrong start; if it acts: refused | refused |
| the plan in force, again | taken | taken |
| another plan, no publisher is new since the run's own plan | taken | taken |
| another plan, a publisher is new, an old one is still there | refused | refused |
| another plan, a publisher is new, the old ones are gone | taken | refused while samples come, then taken |
| another plan, and several publishers were there before it | refused | taken |

What is refused is logged as an error, with the names of the publishers that are new, and changes nothing. A message
does not say who sent it, so a new publisher beside the run's own makes every change of the plan doubtful.
"""

import time
from collections.abc import Callable, Sequence
from typing import Any

from rclpy.node import Node

from satvib_common.errors import SatvibError
from satvib_common.phases import PhasePlan
from satvib_common.ros.convert import check_period, plan_of
from satvib_common.ros.loop.rivals import node_of

_MOST_PHASES = 1000
_MOST_SAMPLES = 2**53
_REMEMBERED = 0.2  # s; to look who publishes takes a millisecond, so a flood is not looked at message by message


class ScheduleGate:
    """The gate of one node.

    Args:
        node: whose log and graph are used.
        topic: of the schedule, as the node names it.
        rate: Hz, sample rate of the node.
        struts: names that a schedule must have; none: any.
        running: whether a run is on now.
        quiet: whether no sample has come for a while: a new run may begin then. A node that is the source of the
            samples is never quiet.
        acts: whether the node works now, with a schedule or without one; not given: while a run is on.
    """

    def __init__(
        self,
        node: Node,
        topic: str,
        rate: float,
        running: Callable[[], bool],
        struts: Sequence[str] = (),
        quiet: Callable[[], bool] = lambda: False,
        acts: Callable[[], bool] | None = None,
    ) -> None:
        self._node, self._topic, self._rate = node, node.resolve_topic_name(topic), rate
        self._running, self._struts, self._quiet = running, list(struts), quiet
        self._acts = acts or running
        self._plan: PhasePlan | None = None
        self._publishers: set[bytes] = set()
        self._foreign: PhasePlan | None = None
        self._foreign_until = 0.0
        self.refused = 0

    def take(self, message: Any) -> PhasePlan | None:
        """Give the plan of a schedule that is taken, or None.

        Raises:
            SatvibError: before a run, a schedule that does not fit this node.
        """
        running = self._running()
        try:
            plan = _plan(message)
        except SatvibError as error:
            self._refuse(error)
            return None
        try:
            self._check_fit(message)
        except SatvibError as error:
            if not self._acts():
                raise
            self._refuse(error)
            return None
        if running and plan == self._plan:
            return plan
        now = time.monotonic()
        if running and plan == self._foreign and now < self._foreign_until:
            self.refused += 1
            return None
        infos = self._node.get_publishers_info_by_topic(self._topic)
        present = {bytes(info.endpoint_gid): node_of(info) for info in infos}
        newcomers = set(present) - self._publishers
        stranger = bool(newcomers) and (bool(set(present) & self._publishers) or not self._quiet())
        doubtful = not running and self._plan not in {None, plan} and len(present) > 1
        if (running and stranger) or doubtful:
            names = ', '.join(sorted(present[gid] for gid in newcomers or present))
            when = ' while a run is on' if running else ''
            self._foreign, self._foreign_until = plan, now + _REMEMBERED
            self._refuse(f'schedule: another one{when}, from {names}')
            return None
        self._plan, self._publishers = plan, set(present)
        return plan

    def _check_fit(self, message: Any) -> None:
        check_period('schedule', message.sample_period, self._rate)
        if self._struts and list(message.struts) != self._struts:
            raise SatvibError(
                f'schedule: its struts are {", ".join(message.struts)}, those of this node '
                f'{", ".join(self._struts)}'
            )

    def _refuse(self, why: object) -> None:
        self.refused += 1
        # a flood is one line for each second
        self._node.get_logger().error(f'refused: {why}', throttle_duration_sec=1.0)


def _plan(message: Any) -> PhasePlan:
    """Read the phases, and refuse numbers that no run can have."""
    if len(message.phases) > _MOST_PHASES:
        raise SatvibError(f'schedule: {len(message.phases)} phases; {_MOST_PHASES} are possible')
    largest = max([message.end_sequence, *message.first_sequence])
    if largest > _MOST_SAMPLES:
        raise SatvibError(f'schedule: sample {largest} is never reached')
    return plan_of(message)
