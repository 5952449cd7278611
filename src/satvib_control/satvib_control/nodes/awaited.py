# SPDX-FileCopyrightText: 2026 The satvib authors
# SPDX-License-Identifier: Apache-2.0
"""What a controller waits for, in words."""

from collections.abc import Sequence
from typing import Any

from satvib_common.ros.reporting import source_of


def awaited_input(node: Any, topics: Sequence[str], schedule: str) -> str:
    """Give which samples, or which schedule, a ControllerNode waits for; empty: for neither.

    Args:
        node: it.
        topics: of its samples.
        schedule: topic of the schedule.
    """
    last, plan = node.last, node.plan
    if node.samples_waiting == 0 and last is None:
        return f'samples on {_first(node, topics)}'
    if plan is None and not node.parameters.control_at_start:
        so_far = 'no sample is answered' if node.in_lockstep else 'STANDBY, 0 V'
        return f'the schedule on {source_of(node, schedule)}; until then {so_far}'
    over = plan is not None and last is not None and last.sequence == plan.end - 1
    if last is None or node.samples_waiting or over or not node.report.is_quiet():
        return ''
    return f'samples on {_first(node, topics)}, after {last.sequence}'


def _first(node: Any, topics: Sequence[str]) -> str:
    """The first topic without a source, or the first."""
    lacking = [topic for topic in topics if not node.count_publishers(topic)]
    return source_of(node, (lacking or topics)[0])
