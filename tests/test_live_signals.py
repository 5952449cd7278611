# SPDX-FileCopyrightText: 2026 The satvib authors
# SPDX-License-Identifier: Apache-2.0
"""A signal at any moment of a node's life ends it with exit code 0 and without a traceback."""

import random
import signal
import subprocess
import time

import pytest
from satvib_common.process.start import start_with_blocked_signals

NODES = [
    ('satvib_control', 'strut_controller', '__ns:=/strut_1'),
    ('satvib_plant_sim', 'plant_sim', '__ns:=/'),
    ('satvib_ident', 'strut_identifier', '__ns:=/strut_1'),
    ('satvib_bringup', 'recorder', '__ns:=/'),
    ('satvib_control', 'supervisor', '__ns:=/'),
    ('satvib_bringup', 'schedule', '__ns:=/'),
    ('satvib_bringup', 'strut', '__ns:=/strut_1'),
    ('satvib_control', 'centralized_controller', '__ns:=/'),
    ('satvib_bringup', 'experiment', '__ns:=/'),
]
# s; a node of these takes half a second to be there, on a busy machine several
LIFE = 2.0


def ends(folder, node, number, moment):
    """Start a node, send the signal after `moment` s; gives exit code and what it said."""
    from satvib_bringup.live.workspace import executable, graph_environment

    package, name, namespace = node
    command = [str(executable(package, name)), '--ros-args', '-r', namespace]
    folder.mkdir(exist_ok=True)
    process = subprocess.Popen(
        command, stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True, env=graph_environment(),
        cwd=folder, preexec_fn=start_with_blocked_signals,
    )  # fmt: skip
    try:
        # the moment is the test, not a wait for something
        process.wait(moment)
    except subprocess.TimeoutExpired:
        process.send_signal(number)
    said, _ = process.communicate(timeout=60.0)
    return process.returncode, said


def try_moments(folder, moments):
    for i, moment in enumerate(moments):
        node = NODES[i % len(NODES)]
        number = (signal.SIGINT, signal.SIGTERM)[i // len(NODES) % 2 if len(moments) > 9 else i % 2]
        code, said = ends(folder / str(i), node, number, moment)
        where = f'{node[1]}, {number.name} after {moment:.3f} s: {said}'
        assert code == 0, where
        assert 'Traceback' not in said, where


@pytest.mark.usefixtures('domain')
def test_a_signal_at_a_random_moment(tmp_path):
    """Truth: the house rule. Four moments, one in each quarter of a life; the first is before the interpreter runs."""
    draw = random.Random(15)
    try_moments(tmp_path, [LIFE * (i + draw.random()) / 4 if i else 0.0 for i in range(4)])


@pytest.mark.long
@pytest.mark.usefixtures('domain')
def test_a_signal_at_fifty_random_moments(tmp_path):
    """Truth: the same; another seed every day, printed by a failure."""
    seed = time.time_ns() // 86_400_000_000_000
    draw = random.Random(seed)
    try_moments(tmp_path, [draw.uniform(0.0, LIFE) for _ in range(50)])


@pytest.mark.usefixtures('domain')
def test_two_signals_of_one_hand(tmp_path):
    """Truth: exit 0. A terminal and a launcher both send SIGINT for one Ctrl-C."""
    from satvib_bringup.live.workspace import executable, graph_environment

    process = subprocess.Popen(
        [str(executable('satvib_plant_sim', 'plant_sim'))],
        stderr=subprocess.PIPE, text=True, env=graph_environment(), cwd=tmp_path,
        preexec_fn=start_with_blocked_signals,
    )  # fmt: skip
    process.send_signal(signal.SIGINT)
    process.send_signal(signal.SIGINT)
    _, said = process.communicate(timeout=60.0)
    assert (process.returncode, said) == (0, '')
