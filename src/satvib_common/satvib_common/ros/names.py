# SPDX-FileCopyrightText: 2026 The satvib authors
# SPDX-License-Identifier: Apache-2.0
"""Where names lead.

A strut's nodes live in the strut's namespace; what belongs to all struts lies one level above it:

    /strut_1/strut_controller  ->  /strut_1/acceleration, /schedule
    /rig_a/strut_1/...         ->  /rig_a/strut_1/acceleration, /rig_a/schedule

So a node started alone in its namespace finds the schedule without a remapping.
"""


def shared(namespace: str, topic: str) -> str:
    """Absolute name of a topic that all struts share, seen from a strut's namespace."""
    parent = namespace.rstrip('/').rpartition('/')[0]
    return f'{parent}/{topic}'


def strut_of(namespace: str) -> str:
    """The strut's name: the last part of the namespace, empty in the root."""
    return namespace.rstrip('/').rpartition('/')[2]
