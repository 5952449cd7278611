# SPDX-FileCopyrightText: 2026 The satvib authors
# SPDX-License-Identifier: Apache-2.0
"""The page's server, pages without a browser, and a browser where there is one."""

import sys
from pathlib import Path

import pytest

sys.path.insert(0, str(Path(__file__).parent))

from browser import Browser, program
from graphs import RATE
from satvib_common.phases import Phase
from watching import Client, Watch


@pytest.fixture
def watch(domain, tmp_path):  # noqa: ARG001 - the domain is in the environment
    made = Watch(tmp_path)
    yield made
    made.end()


@pytest.fixture
def open_client(watch):
    """Open another page."""
    made = []

    def another():
        made.append(Client(watch.address))
        return made[-1]

    yield another
    for client in made:
        client.close()


@pytest.fixture
def client(open_client):
    return open_client()


@pytest.fixture
def browser(tmp_path):
    if program() is None:
        pytest.skip('no Chromium here; on Debian: apt install chromium')
    made = Browser(tmp_path / 'browser')
    yield made
    made.close()


@pytest.fixture
def schedule(probe):
    """Publish a schedule for a graph; it is kept until the test ends."""
    from satvib_common.ros.qos import offered

    from satvib_msgs.msg import Schedule

    made = []

    def publish(above: str = '', phases: tuple = ((Phase.CONTROL, 0),), struts: int = 3) -> None:
        message = Schedule(
            scenario='by hand', sample_period=1.0 / RATE,
            struts=[f'strut_{i + 1}' for i in range(struts)],
            phases=[int(p) for p, _ in phases], first_sequence=[k for _, k in phases],
        )  # fmt: skip
        made.append(probe.node.create_publisher(Schedule, f'{above}/schedule', offered(1)))
        made[-1].publish(message)

    return publish
