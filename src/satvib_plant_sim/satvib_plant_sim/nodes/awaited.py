# SPDX-FileCopyrightText: 2026 The satvib authors
# SPDX-License-Identifier: Apache-2.0
"""What plant_sim waits for, and who else is in its place or its controllers', in words."""

import time
from typing import Any

import numpy as np
from satvib_common.ros.loop.rivals import too_many_writers, two_sources
from satvib_common.ros.reporting import QUIET, source_of
from satvib_common.struts.applied import Applied

from satvib_plant_sim.nodes.realtime_commands import RIVALS

# s, within which a node finds the others, and between two looks
_TO_BE_FOUND, _LOOK = 2.0, 0.02


def others_of(node: Any, strut_index: int) -> str:
    """Give a text that names two controllers of a strut, or two plants; empty: there is one of each."""
    strut = node.names[strut_index]
    return too_many_writers(node, f'{strut}/voltage', f'{strut}/acceleration')


def rivals_of(node: Any, strut_index: int) -> str:
    """Say who answers the samples of a strut twice."""
    if others := others_of(node, strut_index):
        return f'{RIVALS}: {others}'
    topic = f'{node.names[strut_index]}/voltage'
    return two_sources(node, topic, RIVALS, 'its samples are answered twice')


def others_in_the_end(node: Any, strut_index: int) -> str:
    """Give the same as the last words of a plant: one that has just started may not have found the other one yet."""
    deadline = time.monotonic() + _TO_BE_FOUND
    while not (found := others_of(node, strut_index)) and time.monotonic() < deadline:
        time.sleep(_LOOK)
    return found


def awaited(node: Any) -> str:
    """Give what a PlantSimNode waits for; empty: for nothing."""
    names = node.names
    if node.k < 0:
        return '' if node.zero is not None else f'the schedule on {source_of(node, "schedule")}'
    if node.zero is None:
        if time.monotonic() - node.published_at < QUIET:
            return ''
        missing = node.answers.missing(node.k)
        what = f'the voltage of sample {node.k} on '
    else:
        never = np.flatnonzero(node.commands.state == Applied.WAITING)
        missing, what = [names[i] for i in never], 'a first voltage on '
    return what + ' and '.join(source_of(node, f'{n}/voltage') for n in missing) if missing else ''
