# SPDX-FileCopyrightText: 2026 The satvib authors
# SPDX-License-Identifier: Apache-2.0
"""The schedule of a graph as a message."""

from satvib_bringup.graph import Graph
from satvib_msgs.msg import Schedule


def schedule_message(graph: Graph) -> Schedule:
    """Give the message; its stamp is the publisher's."""
    plan = graph.plan
    return Schedule(
        scenario=graph.scenario,
        seed=graph.seed,
        sample_period=graph.sample_period,
        struts=list(graph.struts),
        phases=[int(phase) for phase in plan.phases],
        first_sequence=list(plan.first),
        end_sequence=plan.end,
    )
