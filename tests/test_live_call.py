# SPDX-FileCopyrightText: 2026 The satvib authors
# SPDX-License-Identifier: Apache-2.0
"""`satvib call` and the services of real nodes. Truth: what the nodes say of themselves."""

import signal
import subprocess
import sys

import pytest
from satvib_common.errors import SatvibError

NODE = '/strut_1/strut_controller'
STOP, RESET = f'{NODE}/stop', f'{NODE}/reset'


@pytest.fixture
def call(monkeypatch, capsys):
    """Run `satvib call` in this process; gives exit code, standard output and standard error."""
    from satvib_bringup.cli import main as cli

    monkeypatch.setenv('SATVIB_TRACEBACK', '1')

    def run(*words):
        monkeypatch.setattr(sys, 'argv', ['satvib', 'call', *words])
        with pytest.raises(SystemExit) as caught:
            cli.main()
        shown = capsys.readouterr()
        return caught.value.code or 0, shown.out, shown.err

    return run


def test_a_service_is_called_and_its_node_answers(start, probe, call):
    """Truth: what the controller says when it is stopped and reset, when it is not active, and when it cannot speak."""
    from lifecycle_msgs.msg import Transition
    from satvib_bringup.live.services.caller import Caller

    node = start('satvib_control', 'strut_controller', '/strut_1')
    probe.wait(lambda: STOP in dict(probe.node.get_service_names_and_types()))
    assert call(STOP) == (0, 'success: 0 V from the next sample on, until reset\n', '')
    typed = subprocess.run(
        [sys.executable, '-m', 'satvib_bringup.start', 'call', RESET.lstrip('/')],
        capture_output=True, text=True, timeout=120.0, check=True,
    )  # fmt: skip
    assert (typed.stdout, typed.stderr) == ('success: faults are released\n', '')
    assert probe.change_state(NODE, Transition.TRANSITION_DEACTIVATE)
    assert call(RESET) == (1, 'refused: the node is not active\n', '')

    with Caller() as caller:
        assert caller.trigger(RESET, 60.0) == (False, 'the node is not active')
        for name, told in (
            (RESET.replace('1', '3'), f'no such service here; there are {RESET}'),
            (RESET.replace('reset', 'rest'), f'did you mean {RESET}?'),
            (
                f'{NODE}/get_state',
                'it is of type lifecycle_msgs/srv/GetState; only std_srvs/srv/Trigger',
            ),
        ):
            with pytest.raises(SatvibError, match=f'^{name}: ') as caught:
                caller.trigger(name, 0.1)
            assert told in str(caught.value)
        node.send(signal.SIGSTOP)
        with pytest.raises(SatvibError, match=f'^{RESET}: no answer within 0.5 s$'):
            caller.trigger(RESET, 0.5)


@pytest.mark.usefixtures('domain')
def test_without_a_graph_it_says_so(call):
    """Truth: the domain of this test is empty."""
    code, said, wrong = call(RESET, '--timeout', '0.2')
    assert (code, said, wrong.count('\n')) == (2, '', 1)
    assert 'no such service here; no node of a graph is heard in domain' in wrong
