# SPDX-FileCopyrightText: 2026 The satvib authors
# SPDX-License-Identifier: Apache-2.0
"""An error that nobody foresaw: one line, its details in a file, exit code 70. Truth: the error that is raised here."""

import sys

import pytest
from satvib_bringup.cli import main as cli


def call(monkeypatch, error):
    def app(**_):
        raise error

    monkeypatch.setattr(cli, 'app', app)
    monkeypatch.setattr(sys, 'argv', ['satvib', 'report', 'a\x1bb'])
    cli.main()


@pytest.mark.parametrize('error', [KeyError('a\nb'), MemoryError(), RecursionError('deep')])
def test_an_unforeseen_error_is_one_line_and_a_log(monkeypatch, capsys, tmp_path, error):
    monkeypatch.chdir(tmp_path)
    monkeypatch.delenv('SATVIB_TRACEBACK', raising=False)
    with pytest.raises(SystemExit) as caught:
        call(monkeypatch, error)
    err = capsys.readouterr().err
    assert caught.value.code == 70
    assert err.count('\n') == 1
    assert '\x1b' not in err
    (log,) = tmp_path.glob('satvib-error-*.log')
    assert str(log) in err
    assert type(error).__name__ in log.read_text()
    assert 'Traceback' in log.read_text()


def test_it_can_be_switched_off(monkeypatch):
    monkeypatch.setenv('SATVIB_TRACEBACK', '1')
    with pytest.raises(KeyError, match='x'):
        call(monkeypatch, KeyError('x'))
