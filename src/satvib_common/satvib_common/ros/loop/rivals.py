# SPDX-FileCopyrightText: 2026 The satvib authors
# SPDX-License-Identifier: Apache-2.0
"""Whether two nodes publish on a topic of the loop, which has one writer: by name, for people.

A node that was killed stays in the graph for some seconds. So two names prove nothing as long as the messages are in
order; that is what `satvib_common.sequence.Rivals` looks at.
"""

from typing import Any

UNKNOWN = '_NODE_NAME_UNKNOWN_'  # as rmw has it


def writers_of(node: Any, topic: str) -> list[str]:
    """Give the full names of the nodes that publish on a topic, in order; one for each publisher.

    A publisher may be found before its node's name is, which takes some hundredths of a second.
    """
    infos = node.get_publishers_info_by_topic(node.resolve_topic_name(topic))
    return sorted(
        'a node whose name is not known yet'
        if info.node_name == UNKNOWN
        else f'{info.node_namespace.rstrip("/")}/{info.node_name}'
        for info in infos
    )


def too_many_writers(node: Any, *topics: str) -> str:
    """Give a text that names the writers of the first topic that has more than one; else an empty one."""
    for topic in topics:
        names = writers_of(node, topic)
        if len(names) > 1:
            where = node.resolve_topic_name(topic).lstrip('/')
            return f'{len(names)} publishers on {where}, only one is allowed: {", ".join(names)}'
    return ''
