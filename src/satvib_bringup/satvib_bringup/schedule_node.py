# SPDX-FileCopyrightText: 2026 The satvib authors
# SPDX-License-Identifier: Apache-2.0
"""The node `schedule`: publishes the schedule of a scenario.

It sets a graph going that was started by hand or by the launch file; `satvib run` does that itself.
"""

import sys
from dataclasses import dataclass

from satvib_common.ros.main import run_node
from satvib_common.ros.node import SatvibNode
from satvib_common.ros.qos import offered
from satvib_common.schema import Schema, param

from satvib_bringup.graph import graph_of
from satvib_bringup.scenario import load_scenario
from satvib_bringup.schedule import schedule_message
from satvib_msgs.msg import Schedule as ScheduleMessage


@dataclass(frozen=True, kw_only=True)
class ScheduleParameters(Schema):
    """Which scenario."""

    scenario: str = param('paper_3dof', 'name of a scenario, or path of its file', read_only=True)
    overrides: tuple[str, ...] = param((), "changes, each 'key=value'", read_only=True)


class ScheduleNode(SatvibNode[ScheduleParameters]):
    """Publishes once and stays, for whoever comes later."""

    def __init__(self) -> None:
        super().__init__('schedule', ScheduleParameters)

    def make(self) -> None:
        """Load the scenario."""
        p = self.parameters
        self.graph = graph_of(load_scenario(p.scenario, p.overrides))
        self.publisher = self.publish_on(ScheduleMessage, 'schedule', offered(1))

    def begin(self) -> None:
        """Publish."""
        message = schedule_message(self.graph)
        message.header.stamp = self.get_clock().now().to_msg()
        self.publisher.publish(message)


def main() -> int:
    """Run the node."""
    return run_node(ScheduleNode)


if __name__ == '__main__':
    sys.exit(main())
