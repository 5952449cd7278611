# SPDX-FileCopyrightText: 2026 The satvib authors
# SPDX-License-Identifier: Apache-2.0
"""What an identifier waits for, in words."""

from typing import Any

from satvib_common.ros.reporting import source_of


def awaited(node: Any) -> str:
    """Give what a StrutIdentifierNode waits for; empty: for nothing."""
    last, times = node.core.tracker.last, node.times
    if last is None:
        return f'samples on {source_of(node, "acceleration")}'
    if times is None:
        return f'the schedule on {source_of(node, node.shared("schedule"))}; until then no estimate'
    if not node.hearing.is_quiet() or times.is_over(last):
        return ''
    if waiting := len(node.pairing):
        k = last - waiting + 1 - node.pairing.delay
        return f'the voltage of sample {k} on {source_of(node, "voltage")}'
    return f'samples on {source_of(node, "acceleration")}, after {last}'
