# SPDX-FileCopyrightText: 2026 The satvib authors
# SPDX-License-Identifier: Apache-2.0
"""Who may reach the nodes: this machine alone, unless the user asks for more.

A graph is closed by default: whatever started its nodes, their sockets are on the loopback interface. ROS's own
variables open it:

| variable | graph |
|---|---|
| `ROS_AUTOMATIC_DISCOVERY_RANGE=SUBNET` | open: nodes of the subnet can join |
| `ROS_STATIC_PEERS`, `ROS_DISCOVERY_SERVER` not empty | open: those machines can join |
| `FASTRTPS_DEFAULT_PROFILES_FILE` | what that file of the user says |
| anything else | closed |

The setting LOCALHOST of ROS alone is not enough. It keeps multicast at home, but sockets stay bound to all interfaces.
"""

import os
from collections.abc import MutableMapping
from enum import Enum
from pathlib import Path

PROFILES = 'FASTRTPS_DEFAULT_PROFILES_FILE'
RANGE = 'ROS_AUTOMATIC_DISCOVERY_RANGE'
_CLOSED, _OPEN = 'closed.xml', 'open.xml'


class Reach(Enum):
    """Who may reach the nodes of a process."""

    CLOSED = 'closed'
    OPEN = 'open'
    OWN_FILE = 'own file'
    OTHER_MIDDLEWARE = 'other middleware'


def set_transport(environment: MutableMapping[str, str] = os.environ) -> Reach:
    """Choose the transport of the nodes of a process, before its first context.

    Args:
        environment: that of this process, or the one that a new process gets; changed.
    """
    opened = (
        environment.get(RANGE) == 'SUBNET'
        or bool(environment.get('ROS_STATIC_PEERS'))
        or bool(environment.get('ROS_DISCOVERY_SERVER'))
    )
    if not environment.get('RMW_IMPLEMENTATION', 'rmw_fastrtps_cpp').startswith('rmw_fastrtps'):
        environment.setdefault(RANGE, 'LOCALHOST')
        return Reach.OTHER_MIDDLEWARE
    file = environment.get(PROFILES, '')
    ours = Path(__file__).parent
    if file and Path(file).parts[-2:] not in ((ours.name, _CLOSED), (ours.name, _OPEN)):
        return Reach.OWN_FILE
    environment[PROFILES] = str(ours / (_OPEN if opened else _CLOSED))
    if opened:
        return Reach.OPEN
    if environment.get(RANGE) != 'OFF':
        # any other value makes the middleware add transports of its own, with sockets on all interfaces
        environment[RANGE] = 'SYSTEM_DEFAULT'
    return Reach.CLOSED


def warning(reach: Reach) -> str:
    """Give the line that a person reads when a graph is open, or an empty text."""
    if reach is not Reach.OPEN:
        return ''
    return (
        'the graph is open: nodes on other machines can read it and write to it '
        f'({RANGE}, ROS_STATIC_PEERS or ROS_DISCOVERY_SERVER is set)'
    )
