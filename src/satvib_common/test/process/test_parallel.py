# SPDX-FileCopyrightText: 2026 The satvib authors
# SPDX-License-Identifier: Apache-2.0
"""Work in several processes: nothing is lost when one dies, and no process is left."""

import multiprocessing
import os
import signal
import subprocess
import sys
from contextlib import suppress
from functools import partial
from pathlib import Path

import pytest
from satvib_common.errors import SatvibError
from satvib_common.process.parallel import run_in_processes

# a program whose tasks begin and never end
ENDLESS = """
import sys
import threading

from satvib_common.process.parallel import run_in_processes


def task(number):
    print('begun', flush=True)
    threading.Event().wait()


if __name__ == '__main__':
    try:
        dict(run_in_processes(task, lambda i: (i,), range(4), 2))
    except KeyboardInterrupt:
        sys.exit(130)
"""


def die_once(marker, number):
    """A task whose process dies the first time."""
    try:
        marker.touch(exist_ok=False)
    except FileExistsError:
        return bytes([number])
    os.kill(os.getpid(), signal.SIGKILL)
    raise AssertionError


def die_at(bad, number):
    """A task that always dies at one part."""
    if number == bad:
        os.kill(os.getpid(), signal.SIGKILL)
    return bytes([number])


def no_socket(_number):
    """A task that gives the number of sockets of its process."""
    found = 0
    for link in Path('/proc/self/fd').iterdir():
        with suppress(FileNotFoundError):
            found += str(link.readlink()).startswith('socket:')
    return found


def no_result(number):
    """A task that finds its arguments wrong."""
    raise SatvibError(f'{number}: no such thing')


def test_a_process_that_dies_costs_no_part(tmp_path):
    """Truth: the parts themselves, each once."""
    found = run_in_processes(die_once, lambda i: (tmp_path / 'died', i), range(6), 2)
    assert sorted(found) == [(i, bytes([i])) for i in range(6)]


@pytest.mark.parametrize('workers', [1, 2])
def test_a_part_that_always_kills_its_process_is_named(workers):
    """Truth: part 3 is the one; the parts before it, of which one dies with it, are kept, and no process is left."""
    done = []
    with pytest.raises(SatvibError) as caught:
        done.extend(
            run_in_processes(
                die_at, lambda i: (3, i), range(4), workers,
                lives=2, called='the part {}'.format, advice='do less',
            )
        )  # fmt: skip
    assert str(caught.value) == (
        'the part 3: 2 times a process died while it ran it (too little memory?); do less'
    )
    assert sorted(done) == [(i, bytes([i])) for i in range(3)]
    assert multiprocessing.active_children() == []


def test_an_error_of_a_task_is_that_of_the_caller():
    """Truth: the error that the task raises; no process is left."""
    with pytest.raises(SatvibError, match='0: no such thing'):
        dict(run_in_processes(no_result, lambda i: (i,), range(1), 1))
    assert multiprocessing.active_children() == []


def test_processes_of_this_machine_open_no_socket():
    """Truth: the descriptors of the processes. Whoever could connect could run code there."""
    found = dict(run_in_processes(no_socket, lambda i: (i,), range(2), 2))
    assert found == {0: 0, 1: 0}


@pytest.mark.parametrize('number', [signal.SIGINT, signal.SIGKILL])
def test_no_process_outlives_its_parent(tmp_path, number):
    """Truth: every process holds the pipe that is read here, so its end is the end of all.

    Control-C goes to all of them, and none of them writes a traceback.
    """
    program = tmp_path / 'endless.py'
    program.write_text(ENDLESS)
    env = os.environ | {'PYTHONPATH': os.pathsep.join(path for path in sys.path if path)}
    with subprocess.Popen(
        [sys.executable, str(program)], env=env, text=True, start_new_session=True,
        stdout=subprocess.PIPE, stderr=subprocess.PIPE,
        # a shell lets what it starts with & not hear Control-C, and a test may be below such a shell
        preexec_fn=partial(signal.signal, signal.SIGINT, signal.SIG_DFL),
    ) as parent:  # fmt: skip
        for _ in range(2):
            assert parent.stdout.readline() == 'begun\n'
        if number == signal.SIGINT:
            os.killpg(parent.pid, number)  # as a terminal does
        else:
            parent.send_signal(number)
        _, errors = parent.communicate(timeout=60)
    assert parent.returncode == (130 if number == signal.SIGINT else -number)
    if number == signal.SIGINT:
        assert errors == ''
