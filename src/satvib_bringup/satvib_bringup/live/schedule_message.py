# SPDX-FileCopyrightText: 2026 The satvib authors
# SPDX-License-Identifier: Apache-2.0
"""The schedule of a graph as a message."""

from builtin_interfaces.msg import Time
from std_msgs.msg import Header

from satvib_bringup.live.graph import Graph
from satvib_msgs.msg import Schedule


def schedule_message(graph: Graph, stamp: Time) -> Schedule:
    """Give the message that sets a graph going at a time."""
    plan = graph.plan
    return Schedule(
        header=Header(stamp=stamp),
        scenario=graph.scenario,
        seed=graph.seed,
        sample_period=graph.sample_period,
        struts=list(graph.struts),
        phases=[int(phase) for phase in plan.phases],
        first_sequence=list(plan.first),
        end_sequence=plan.end,
    )
