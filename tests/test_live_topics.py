# SPDX-FileCopyrightText: 2026 The satvib authors
# SPDX-License-Identifier: Apache-2.0
"""`satvib node` and `satvib topics`, typed as people type them."""

import re
import signal
import subprocess
import sys

import pytest


def command(*words):
    return [sys.executable, '-m', 'satvib_bringup.start', *words]


def satvib(*words):
    """Run a command that ends by itself; gives exit code, output and errors."""
    done = subprocess.run(
        command(*words), capture_output=True, text=True, timeout=120.0, check=False
    )
    return done.returncode, done.stdout, done.stderr


@pytest.fixture
def graph(probe, tmp_path):
    """A plant in real time and a controller, both by `satvib node`, 100 samples a second."""
    from satvib_msgs.msg import Schedule

    with (tmp_path / 'log').open('w') as log:
        started = [
            subprocess.Popen(command('node', *words), stdout=log, stderr=log)
            for words in (
                ('satvib_plant_sim', 'plant_sim', '--ros-args', '-p', 'lockstep:=false'),
                ('satvib_control', 'strut_controller', '--ros-args', '-r', '__ns:=/strut_1',
                 '-p', 'lockstep:=false', '-p', 'law:=velocity_feedback'),
            )
        ]  # fmt: skip
        out = probe.publisher(Schedule, '/schedule')
        probe.wait(lambda: out.get_subscription_count() == 2)
        out.publish(
            Schedule(
                scenario='test', sample_period=0.01, struts=['strut_1', 'strut_2', 'strut_3'],
                phases=[4], first_sequence=[0],
            )
        )  # fmt: skip
        yield started
        for process in started:
            process.send_signal(signal.SIGINT)
        assert [process.wait(60.0) for process in started] == [0, 0]


def test_list_rate_and_echo(graph):  # noqa: ARG001
    """Truth: the graph: who writes what, 100 Hz within 20 % on a busy machine, and the phase of the schedule."""
    code, said, _ = satvib('topics')
    assert code == 0
    assert re.search(
        r'/strut_1/voltage +│ satvib_msgs/VcaVoltage +│ /strut_1/strut_contr\w* ', said
    ), said
    code, said, _ = satvib('topics', 'rate', '/strut_1/acceleration', '--seconds', '2')
    assert code == 0
    (found,) = re.findall(r'/strut_1/acceleration +│ +(\d+) +│ +([\d.]+) ', said)
    assert float(found[1]) == pytest.approx(100.0, rel=0.2)
    code, said, _ = satvib('topics', 'echo', '/strut_1/controller_state', '--count', '2')
    assert code == 0
    assert said.count('phase: 4 (CONTROL)') == 2
    assert said.count('law: velocity_feedback') == 2
    code, said, _ = satvib('topics', 'echo', 'schedule', '--count', '1')
    assert 'scenario: test' in said.splitlines()
    code, _, wrong = satvib('topics', 'echo', '/strut_1/acceleratoin')
    assert code == 2
    assert 'did you mean /strut_1/acceleration?' in wrong
    assert wrong.count('\n') == 1


@pytest.mark.usefixtures('domain')
def test_without_a_graph():
    """Truth: the domain of this test is empty."""
    code, said, _ = satvib('topics')
    assert (code, said.count('\n')) == (0, 1)
    assert 'No satvib graph is running' in said


def test_node_lists_and_refuses():
    """Truth: the entry points of the packages."""
    code, said, _ = satvib('node')
    assert code == 0
    for name in ('plant_sim', 'strut_controller', 'daq_bridge', 'recorder', 'strut_identifier'):
        assert f' {name} ' in said
    for words in (('satvib_contol', 'x'), ('satvib_control', 'x'), ('satvib_control',)):
        code, _, wrong = satvib('node', *words)
        assert code == 2
        assert wrong.count('\n') == 1
        assert 'strut_controller' in wrong or 'satvib_control' in wrong
