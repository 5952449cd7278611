# SPDX-FileCopyrightText: 2026 The satvib authors
# SPDX-License-Identifier: Apache-2.0
"""The name of a node that publishes. Truth: the names that were put in, and what rmw writes for one that it has not."""

from pathlib import Path

import pytest

pytest.importorskip('rclpy')

from rclpy.qos import QoSProfile
from rclpy.topic_endpoint_info import TopicEndpointInfo
from rclpy.type_hash import TypeHash
from satvib_common.ros.loop.rivals import NAMELESS, node_of

PACKAGES = Path(__file__).parents[4]


def endpoint(namespace, name):
    return TopicEndpointInfo(
        node_namespace=namespace, node_name=name, topic_type='x/msg/X', topic_type_hash=TypeHash(),
        endpoint_type=1, endpoint_gid=[0], qos_profile=QoSProfile(depth=1),
    )  # fmt: skip


def test_a_name_that_is_not_known_yet_is_said_in_words():
    assert node_of(endpoint('/a', 'b')) == '/a/b'
    assert node_of(endpoint('/', 'b')) == '/b'
    assert node_of(endpoint('_NODE_NAMESPACE_UNKNOWN_', '_NODE_NAME_UNKNOWN_')) == NAMELESS


def test_no_other_module_puts_the_name_of_a_publisher_together():
    """Truth: the sources; `node_namespace` is read in one place."""
    found = {
        path.name
        for path in PACKAGES.glob('satvib_*/satvib_*/**/*.py')
        if 'node_namespace' in path.read_text(encoding='utf-8')
    }
    assert found == {'rivals.py'}
