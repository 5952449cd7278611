# SPDX-FileCopyrightText: 2026 The satvib authors
# SPDX-License-Identifier: Apache-2.0
"""Which sockets a graph has. Truth: the kernel's own lists, /proc/PID/net and the descriptors of the process."""

import contextlib
import os
import re
import shutil
import subprocess
import sys
from collections import defaultdict
from pathlib import Path

import pytest

LOOPBACK = '0100007F'
PAGE = Path(__file__).parent.parent / 'docs' / 'network.md'
# all phases, in less time
BRIEF = [
    'duration=6.0', 'phases.2.start=2.0', 'phases.3.start=3.0', 'disturbance.start=2.0', 'analysis={}',
]  # fmt: skip
# a node of somebody else, with the settings that ROS has by itself
FOREIGNER = """
import rclpy
from rcl_interfaces.srv import GetParameters

rclpy.init()
node = rclpy.create_node('foreigner')
client = node.create_client(GetParameters, '/plant_sim/get_parameters')
while not client.wait_for_service(1.0):
    pass
while True:
    answer = client.call_async(GetParameters.Request(names=['rig']))
    rclpy.spin_until_future_complete(node, answer, timeout_sec=5.0)
    if answer.done():
        break
print(answer.result().values[0].string_value)
"""


def without_settings(monkeypatch):
    """As in a shell in which nothing but ROS is sourced."""
    for name in ('FASTRTPS_DEFAULT_PROFILES_FILE', 'ROS_AUTOMATIC_DISCOVERY_RANGE'):
        monkeypatch.delenv(name, raising=False)


@contextlib.contextmanager
def plain_node(folder, monkeypatch, discovery_range):
    """plant_sim as `ros2 run` starts it, without any setting of ours, and the file with what it says."""
    from satvib_bringup.live.workspace import executable

    without_settings(monkeypatch)
    if discovery_range is not None:
        monkeypatch.setenv('ROS_AUTOMATIC_DISCOVERY_RANGE', discovery_range)
    log = folder / 'plant.log'
    with log.open('wb') as sink:
        command = [str(executable('satvib_plant_sim', 'plant_sim'))]
        process = subprocess.Popen(command, stdout=sink, stderr=subprocess.STDOUT, cwd=folder)
        try:
            yield process, log
        finally:
            process.kill()
            process.wait()


def shown_by_the_page(pid: int) -> int:
    """How many sockets of a process the command of the page shows."""
    lines = PAGE.read_text(encoding='utf-8').splitlines()
    first = next(i for i, line in enumerate(lines) if line.startswith('    first='))
    last = next(i for i, line in enumerate(lines) if i >= first and not line)
    script = '\n'.join(lines[first:last])
    done = subprocess.run(['bash', '-c', script], capture_output=True, text=True, check=True)
    return sum(f'pid={pid},' in line for line in done.stdout.splitlines())


def sockets(pid: int) -> set[str]:
    """Local addresses (hexadecimal, as the kernel writes them) of the UDP and TCP sockets of a process."""
    inodes = set()
    for link in Path(f'/proc/{pid}/fd').iterdir():
        try:
            if found := re.fullmatch(r'socket:\[(\d+)\]', str(link.readlink())):
                inodes.add(found[1])
        except FileNotFoundError:
            continue
    addresses = set()
    for kind in ('udp', 'udp6', 'tcp', 'tcp6'):
        table = Path(f'/proc/{pid}/net/{kind}')
        for line in table.read_text().splitlines()[1:] if table.exists() else ():
            fields = line.split()
            if fields[9] in inodes:
                addresses.add(fields[1].partition(':')[0])
    return addresses


@pytest.mark.parametrize(
    ('discovery_range', 'closed'), [(None, True), ('LOCALHOST', True), ('SUBNET', False)]
)
def test_a_node_listens_on_the_loopback_interface_alone(
    domain,  # noqa: ARG001
    probe,
    tmp_path,
    monkeypatch,
    discovery_range,
    closed,
):
    """However it was started: `ros2 run` sets no variable, ./satvib sets LOCALHOST. SUBNET opens it, and it says so.

    The command of the page shows them: two ports of the domain, one to send from, one more.
    """
    with plain_node(tmp_path, monkeypatch, discovery_range) as (process, log):
        assert probe.state_of('/plant_sim') == 'active'
        found = sockets(process.pid)
        assert found
        assert (found == {LOOPBACK}) == closed, found
        assert ('the graph is open' in log.read_text()) != closed
        if shutil.which('ss'):
            assert shown_by_the_page(process.pid) >= 4


def test_every_process_of_a_run_is_on_the_loopback_interface_alone(
    domain,  # noqa: ARG001
    tmp_path,
    monkeypatch,
):
    """Runner, plant, controller, identifier and recorder, while samples flow; no variable is set."""
    from satvib_bringup.live.run import run_experiment
    from satvib_experiment.scenario.scenario import load_scenario

    without_settings(monkeypatch)
    found = defaultdict(set)

    def look(progress):
        if progress.sequence > 200:
            for pid in [os.getpid(), *members()]:
                with contextlib.suppress(OSError):  # it has ended
                    found[pid] |= sockets(pid)

    def members():
        for path in Path('/proc').glob('[0-9]*/cmdline'):
            with contextlib.suppress(OSError):
                if str(tmp_path / 'run').encode() in path.read_bytes():
                    yield int(path.parent.name)

    outcome = run_experiment(
        load_scenario('paper_1dof_10hz', BRIEF),
        tmp_path / 'run',
        progress=look,
        composition='separate',
    )
    assert outcome.success, outcome.message
    assert len([pid for pid, addresses in found.items() if addresses]) >= 5
    assert set().union(*found.values()) == {LOOPBACK}


@pytest.mark.parametrize(
    'words', [('topics', 'rate', '--seconds', '300'), ('watch', '--port', '0')]
)
def test_a_command_that_joins_a_graph_is_on_the_loopback_interface_alone(
    domain,  # noqa: ARG001
    probe,
    tmp_path,
    monkeypatch,
    words,
):
    without_settings(monkeypatch)
    command = [sys.executable, '-m', 'satvib_bringup.cli.main', *words]
    before = set(probe.node.get_node_names_and_namespaces())
    process = subprocess.Popen(command, stdout=subprocess.DEVNULL, cwd=tmp_path)
    try:
        probe.wait(lambda: set(probe.node.get_node_names_and_namespaces()) - before)
        assert sockets(process.pid) == {LOOPBACK}
    finally:
        process.kill()
        process.wait()


@pytest.mark.parametrize('discovery_range', [None, 'LOCALHOST'])
def test_tools_with_the_settings_of_ros_reach_a_closed_graph(
    domain,  # noqa: ARG001
    tmp_path,
    monkeypatch,
    discovery_range,
):
    """`ros2 topic echo`, rqt, PlotJuggler: on the same machine they need no setting of ours."""
    with plain_node(tmp_path, monkeypatch, discovery_range):
        done = subprocess.run(
            [sys.executable, '-c', FOREIGNER],
            capture_output=True,
            text=True,
            timeout=120,
            check=True,
        )
    assert done.stdout.strip() == 'paper_3dof'
