# SPDX-FileCopyrightText: 2026 The satvib authors
# SPDX-License-Identifier: Apache-2.0
"""The node `schedule`: publishes the schedule of a scenario.

It starts the run of a graph that was started by hand or by the launch file; `satvib run` does that itself. In lockstep
nothing is lost when a node comes late, and it publishes at once. With `realtime` it waits until all nodes have found
each other.
"""

import time
from dataclasses import dataclass
from pathlib import Path

from diagnostic_msgs.msg import DiagnosticArray
from satvib_common.ros.main import run_node
from satvib_common.ros.node import SatvibNode
from satvib_common.ros.qos import offered
from satvib_common.schema import Fixed, Schema, param
from satvib_experiment.scenario.scenario import load_scenario

from satvib_bringup.live.discovery import REPORTS, Discovery
from satvib_bringup.live.graph import graph_of, with_bridge
from satvib_bringup.live.schedule_message import graph_schedule
from satvib_msgs.msg import Schedule as ScheduleMessage

_PATIENCE = 60.0  # s
_LOOK = 0.05  # s


@dataclass(frozen=True, kw_only=True)
class ScheduleParameters(Schema):
    """Which scenario."""

    scenario: str = param(
        'paper_3dof', 'name of a scenario, or path of its file', read_only=Fixed.START
    )
    overrides: tuple[str, ...] = param((), "changes, each 'key=value'", read_only=Fixed.START)
    realtime: bool = param(
        False, 'wait until the nodes of the scenario have found one another', read_only=Fixed.START
    )
    composition: str = param(
        '', 'how the nodes share processes; empty: as the scenario says', read_only=Fixed.START
    )
    channels: str = param(
        '', 'on real hardware: path of the channels file; empty: simulation', read_only=Fixed.START
    )
    recorded: bool = param(False, 'with realtime: a recorder is one of them', read_only=Fixed.START)


class ScheduleNode(SatvibNode[ScheduleParameters]):
    """Publishes once and stays, for nodes that start later."""

    def __init__(self) -> None:
        super().__init__('schedule', ScheduleParameters)

    def configure(self) -> None:
        """Load the scenario."""
        p = self.parameters
        bag = Path('bag') if p.recorded else None
        scenario = load_scenario(p.scenario, p.overrides)
        self.graph = graph_of(scenario, p.realtime, bag, p.composition)
        if p.channels:
            self.graph = with_bridge(self.graph, p.channels)
        self.publisher = self.publish_on(ScheduleMessage, 'schedule', offered(1))
        self.discovery = Discovery(self.graph, self, self.publisher)
        self.waits = False

    def activate(self) -> None:
        """Publish, or wait for the others."""
        self.waits = self.parameters.realtime
        self.deadline = time.monotonic() + _PATIENCE
        if self.waits:
            self.listen_to(DiagnosticArray, '/diagnostics', self.discovery.on_diagnostics, REPORTS)
        else:
            self._publish()

    def tick(self) -> float:
        """Publish as soon as all nodes have found each other."""
        if not self.waits:
            return super().tick()
        missing = self.discovery.missing()
        if missing and time.monotonic() < self.deadline:
            return _LOOK
        if missing:
            self.get_logger().warning(
                f'begins although the graph is not complete after {_PATIENCE:g} s: {missing[0]}'
            )
        self.waits = False
        self._publish()
        return super().tick()

    def awaits(self) -> str:
        """Give the first that is missing."""
        missing = self.discovery.missing() if self.waits else []
        return f'{missing[0]}, before the schedule is published' if missing else ''

    def _publish(self) -> None:
        now = self.get_clock().now().to_msg()
        self.publisher.publish(graph_schedule(self.graph, now))


def main() -> None:
    """Run the node."""
    run_node(ScheduleNode)


if __name__ == '__main__':
    main()
