# SPDX-FileCopyrightText: 2026 The satvib authors
# SPDX-License-Identifier: Apache-2.0
"""Who publishes on a topic of the loop, which has one writer, and whether it is two nodes: by name, for people.

A node that was killed stays in the graph for some seconds. So two names prove nothing as long as the messages are in
order; that is what `satvib_common.sequence.Rivals` looks at.
"""

from typing import Any

UNKNOWN = '_NODE_NAME_UNKNOWN_'  # as rmw has it
NAMELESS = 'a node whose name is not known yet'


def node_of(info: Any) -> str:
    """Give the full name of the node that has an endpoint (a `TopicEndpointInfo`), for people.

    An endpoint may be found before its node's name is, which takes some hundredths of a second.
    """
    if info.node_name == UNKNOWN:
        return NAMELESS
    return f'{info.node_namespace.rstrip("/")}/{info.node_name}'


def writers_of(node: Any, topic: str) -> list[str]:
    """Give the full names of the nodes that publish on a topic, in order; one for each publisher."""
    return sorted(map(node_of, node.get_publishers_info_by_topic(node.resolve_topic_name(topic))))


def too_many_writers(node: Any, *topics: str) -> str:
    """Give a text that names the writers of the first topic that has more than one; else an empty one."""
    for topic in topics:
        names = writers_of(node, topic)
        if len(names) > 1:
            where = node.resolve_topic_name(topic).lstrip('/')
            return f'{len(names)} publishers on {where}, only one is allowed: {", ".join(names)}'
    return ''


def two_sources(node: Any, topic: str, two: str, one: str) -> str:
    """Say who publishes messages that are in such an order as if two sources spoke.

    Args:
        node: whose graph is asked.
        topic: of the messages, as the node names it.
        two: the first words when several nodes publish there, or none that is known.
        one: the first words when it is one node: it doubles its messages, or the way to here does.
    """
    if rivals := too_many_writers(node, topic):
        return f'{two}: {rivals}'
    if names := writers_of(node, topic):
        where = node.resolve_topic_name(topic).lstrip('/')
        return f'{one}: {names[0]} publishes each twice or out of order on {where}'
    return two
