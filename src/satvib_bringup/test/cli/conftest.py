# SPDX-FileCopyrightText: 2026 The satvib authors
# SPDX-License-Identifier: Apache-2.0
"""The satvib command in the process of the test."""

import sys

import pytest
from satvib_bringup.cli import main as cli


@pytest.fixture
def satvib(monkeypatch, capsys, tmp_path):
    """Run the command in an empty folder; gives exit code, standard output and standard error."""
    monkeypatch.chdir(tmp_path)
    monkeypatch.setenv('COLUMNS', '110')
    monkeypatch.setenv('SATVIB_TRACEBACK', '1')  # a defect is to show itself

    def call(*arguments):
        monkeypatch.setattr(sys, 'argv', ['satvib', *map(str, arguments)])
        with pytest.raises(SystemExit) as caught:
            cli.main()
        shown = capsys.readouterr()
        return caught.value.code or 0, shown.out, shown.err

    return call
