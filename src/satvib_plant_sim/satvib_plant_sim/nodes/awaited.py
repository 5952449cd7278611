# SPDX-FileCopyrightText: 2026 The satvib authors
# SPDX-License-Identifier: Apache-2.0
"""What plant_sim waits for, in words."""

import time
from typing import Any

import numpy as np
from satvib_common.ros.reporting import QUIET, source_of
from satvib_common.struts.applied import Applied


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
