# SPDX-FileCopyrightText: 2026 The satvib authors
# SPDX-License-Identifier: Apache-2.0
"""Processes are started, watched, stopped, and none is left. The children here are small Python programs."""

import os
import signal
import sys
import time

import pytest
from satvib_bringup.live.supervisor import Exit, Supervisor, last_line
from satvib_common.errors import SatvibError

LIMIT = 30.0


def python(text):
    return [sys.executable, '-c', text]


def wait_for(condition):
    deadline = time.monotonic() + LIMIT
    while not (result := condition()):
        assert time.monotonic() < deadline
    return result


READY = 'import sys, signal; print("ready", flush=True); '


@pytest.fixture
def supervisor(tmp_path):
    with Supervisor(tmp_path / 'logs') as made:
        yield made


def is_ready(supervisor, name):
    return lambda: last_line(supervisor.logs / f'{name.replace("/", ".")}.log') == 'ready'


def test_the_first_that_ends_is_named_with_its_last_words(supervisor):
    """Truth: the program's own exit code and last line; said once."""
    supervisor.start(
        'a/node', python('import sys; print("x"); print("node: no disk"); sys.exit(3)')
    )
    (ended,) = wait_for(supervisor.ended)
    assert ended == Exit('a/node', 3, 'node: no disk')
    assert str(ended) == 'a/node ended with exit code 3: no disk'
    assert supervisor.ended() == []


def test_a_killed_process_is_told_by_its_signal_and_before_the_others(supervisor):
    """Truth: SIGKILL by this test; the one that was killed explains the one that failed."""
    supervisor.start('fails', python('import sys; sys.exit(1)'))
    pid = supervisor.start('killed', python(READY + 'signal.pause()'))
    wait_for(is_ready(supervisor, 'killed'))
    os.kill(pid, signal.SIGKILL)
    wait_for(lambda: not supervisor.is_running('killed') and not supervisor.is_running('fails'))
    ended = supervisor.ended()
    assert [e.name for e in ended] == ['killed', 'fails']
    assert ended[0].how == 'was killed by SIGKILL'


INFO = '[INFO] [1.5] [node]: the voltage reaches its coil'
REASON = '[ERROR] [1.6] [node]: no disk'


@pytest.mark.parametrize(
    ('lines', 'end', 'told'),
    [
        ([INFO], 'sys.exit(1)', ''),
        ([REASON, INFO], 'sys.exit(1)', REASON),
        (['node: no disk', INFO.replace('INFO', 'WARN')], 'sys.exit(1)', 'node: no disk'),
        ([INFO], '1 / 0', 'ZeroDivisionError: division by zero'),
        ([REASON], 'os.kill(os.getpid(), 9)', ''),
        ([REASON, INFO], 'os.kill(os.getpid(), 6)', REASON),
    ],
)
def test_a_reason_is_an_error_and_a_killed_process_has_none(supervisor, lines, end, told):
    """Truth: the lines and the end of the program, by hand."""
    supervisor.start(
        'node', python(f'import os, sys; print({chr(10).join(lines)!r}, flush=True); {end}')
    )
    (ended,) = wait_for(supervisor.ended)
    assert ended.last_line == told
    assert 'INFO' not in str(ended)


def test_stop_asks_first_and_kills_who_does_not_listen(supervisor):
    """Truth: the programs. One ends by itself on SIGTERM, the other ignores it."""
    supervisor.start(
        'good', python(READY + 'signal.signal(15, lambda *_: sys.exit(0)); signal.pause()')
    )
    deaf = (
        'import signal; signal.signal(15, signal.SIG_IGN); '
        + READY
        + '[signal.pause() for _ in "12"]'
    )
    supervisor.start('deaf', python(deaf))
    for name in ('good', 'deaf'):
        wait_for(is_ready(supervisor, name))
    codes = {e.name: e.code for e in supervisor.stop(['good', 'deaf'], patience=0.5)}
    assert codes['deaf'] == -signal.SIGKILL
    assert codes['good'] in {0, -signal.SIGTERM}
    assert supervisor.pids() == {}


def test_leaving_the_supervisor_leaves_nothing(tmp_path):
    """Truth: waiting for the process's descriptor, also when an exception leaves the block."""
    handles = []

    def fail():
        with Supervisor(tmp_path) as supervisor:
            pid = supervisor.start('x', python('import signal; signal.pause()'))
            handles.append(os.pidfd_open(pid))
            raise KeyError

    with pytest.raises(KeyError):
        fail()
    # the process has been waited for, so its descriptor cannot be signalled any more
    with pytest.raises(ProcessLookupError):
        signal.pidfd_send_signal(handles[0], signal.SIGTERM)
    os.close(handles[0])


def test_a_child_dies_with_its_parent_however_that_dies(tmp_path):
    """Truth: the grandchild's descriptor becomes readable when it has ended; its parent was killed with SIGKILL."""
    import select
    import subprocess

    program = (
        'import sys, time\n'
        'from pathlib import Path\n'
        'from satvib_bringup.live.supervisor import Supervisor\n'
        's = Supervisor(Path(sys.argv[1]))\n'
        "print(s.start('c', [sys.executable, '-c', 'import signal; signal.pause()']), flush=True)\n"
        'time.sleep(1000)\n'
    )
    with subprocess.Popen(
        [sys.executable, '-c', program, str(tmp_path)], stdout=subprocess.PIPE, text=True,
        env=os.environ | {'PYTHONPATH': os.pathsep.join(sys.path)},
    ) as parent:  # fmt: skip
        assert parent.stdout is not None
        handle = os.pidfd_open(int(parent.stdout.readline()))
        parent.kill()
        ready, _, _ = select.select([handle], [], [], LIMIT)
    assert ready
    os.close(handle)


def test_a_missing_program_is_one_line(supervisor):
    """Truth: a path that does not exist."""
    with pytest.raises(SatvibError, match=r'node: cannot be started: .*No such file'):
        supervisor.start('node', ['/does/not/exist'])
