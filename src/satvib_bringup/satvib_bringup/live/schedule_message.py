# SPDX-FileCopyrightText: 2026 The satvib authors
# SPDX-License-Identifier: Apache-2.0
"""The message that starts a run."""

from collections.abc import Sequence

from builtin_interfaces.msg import Time
from satvib_common.phases import PhasePlan
from std_msgs.msg import Header

from satvib_bringup.live.graph import Graph
from satvib_msgs.msg import Schedule


def schedule_message(
    plan: PhasePlan,
    stamp: Time,
    struts: Sequence[str],
    sample_period: float,
    scenario: str = '',
    seed: int = 0,
) -> Schedule:
    """Give the message of a plan.

    Args:
        plan: phases by sample.
        stamp: now.
        struts: their names.
        sample_period: s.
        scenario: its name.
        seed: of everything random.
    """
    return Schedule(
        header=Header(stamp=stamp),
        scenario=scenario,
        seed=seed,
        sample_period=sample_period,
        struts=list(struts),
        phases=[int(phase) for phase in plan.phases],
        first_sequence=list(plan.first),
        end_sequence=plan.end,
    )


def graph_schedule(graph: Graph, stamp: Time) -> Schedule:
    """Give the message that starts a graph."""
    return schedule_message(
        graph.plan, stamp, graph.struts, graph.sample_period, graph.scenario, graph.seed
    )
