# SPDX-FileCopyrightText: 2026 The satvib authors
# SPDX-License-Identifier: Apache-2.0
"""Signals before a program has handlers of its own."""

import signal
import subprocess
import sys

import pytest
from satvib_common.process.start import start_with_blocked_signals

CODE = """
import sys
from pathlib import Path
from satvib_common.process.start import starter
Path(sys.argv[1], 'slow.py').write_text('print("imports", flush=True)\\nimport time\\ntime.sleep(600)\\n')
sys.path.insert(0, sys.argv[1])
starter('slow', code=7, line='was interrupted')()
"""


@pytest.mark.parametrize('number', [signal.SIGINT, signal.SIGTERM])
@pytest.mark.parametrize('moment', ['at once', 'while it imports'])
def test_a_signal_before_the_program_runs(tmp_path, number, moment):
    """Truth: the code and the line that `starter` was given. `at once`: the interpreter has not even begun."""
    process = subprocess.Popen(
        [sys.executable, '-c', CODE, str(tmp_path)],
        stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True, preexec_fn=start_with_blocked_signals,
    )  # fmt: skip
    if moment != 'at once':
        assert process.stdout.readline() == 'imports\n'
    process.send_signal(number)
    _, said = process.communicate(timeout=60.0)
    assert (process.returncode, said) == (7, 'was interrupted\n')
