# SPDX-FileCopyrightText: 2026 The satvib authors
# SPDX-License-Identifier: Apache-2.0
"""Who may reach a node, by its environment. Truth: the table of the module, and the two files themselves."""

import re
from pathlib import Path

import pytest
from satvib_common.transport import reach
from satvib_common.transport.reach import PROFILES, RANGE, Reach, set_transport, warning


@pytest.mark.parametrize(
    ('given', 'expected', 'file', 'discovery_range'),
    [
        ({}, Reach.CLOSED, 'closed.xml', 'SYSTEM_DEFAULT'),
        ({RANGE: 'LOCALHOST'}, Reach.CLOSED, 'closed.xml', 'SYSTEM_DEFAULT'),
        ({RANGE: 'OFF'}, Reach.CLOSED, 'closed.xml', 'OFF'),
        ({RANGE: 'SUBNET'}, Reach.OPEN, 'open.xml', 'SUBNET'),
        ({'ROS_STATIC_PEERS': '192.0.2.7'}, Reach.OPEN, 'open.xml', None),
        ({'ROS_DISCOVERY_SERVER': '192.0.2.7:11811'}, Reach.OPEN, 'open.xml', None),
        ({'ROS_STATIC_PEERS': ''}, Reach.CLOSED, 'closed.xml', 'SYSTEM_DEFAULT'),
        ({PROFILES: '/my/own.xml'}, Reach.OWN_FILE, 'own.xml', None),
        ({'RMW_IMPLEMENTATION': 'rmw_cyclonedds_cpp'}, Reach.OTHER_MIDDLEWARE, '', 'LOCALHOST'),
    ],
)  # fmt: skip
def test_the_environment_decides(given, expected, file, discovery_range):
    environment = dict(given)
    assert set_transport(environment) is expected
    assert Path(environment.get(PROFILES, '')).name == file
    assert environment.get(RANGE) == discovery_range
    # a process that was started with this environment decides the same
    again = dict(environment)
    assert set_transport(again) is expected
    assert again == environment


def test_only_an_open_graph_is_worth_a_line():
    assert [bool(warning(each)) for each in Reach] == [r is Reach.OPEN for r in Reach]


def test_the_files_differ_by_their_transports_alone():
    def plain(name):
        text = Path(reach.__file__).parent / name
        return re.sub(r'<!--.*?-->|\s', '', text.read_text(), flags=re.DOTALL)

    closed, opened = plain('closed.xml'), plain('open.xml')
    for text in (closed, opened):
        assert re.findall('<type>.*?</type>', text) == ['<type>UDPv4</type>']
        assert '<useBuiltinTransports>false</useBuiltinTransports>' in text
    for tag in (
        'transport_descriptors', 'userTransports', 'metatrafficUnicastLocatorList', 'initialPeersList',
    ):  # fmt: skip
        closed, count = re.subn(f'<{tag}>.*?</{tag}>', '', closed)
        assert count == 1, tag
        opened = re.sub(f'<{tag}>.*?</{tag}>', '', opened)
    assert closed == opened
