# SPDX-FileCopyrightText: 2026 The satvib authors
# SPDX-License-Identifier: Apache-2.0
"""Every script of benchmarks/ starts: what it imports is there, and it says how it is used."""

import json
import subprocess
import sys
from pathlib import Path

import pytest

ROOT = Path(__file__).resolve().parents[4]
SCRIPTS = sorted((ROOT / 'benchmarks').glob('*.py'))
# One process imports the libraries, and every script gets a copy of it: its own modules are its own business.
START_ALL = """
import contextlib, io, json, os, runpy, sys, traceback
import matplotlib.figure, numba, numpy, rich, scipy.signal
found = {}
for script in sys.argv[1:]:
    reading, writing = os.pipe()
    if child := os.fork():
        os.close(writing)
        with open(reading) as said:
            found[script] = json.loads(said.read() or 'null')
        os.waitpid(child, 0)
        continue
    out, code = io.StringIO(), 'no SystemExit'
    sys.argv, sys.path[0] = [script, '--help'], os.path.dirname(script)
    with contextlib.redirect_stdout(out), contextlib.redirect_stderr(out):
        try:
            runpy.run_path(script, run_name='__main__')
        except SystemExit as end:
            code = end.code
        except BaseException:
            traceback.print_exc()
    with open(writing, 'w') as answer:
        json.dump([code, out.getvalue()], answer)
    os._exit(0)
print(json.dumps(found))
"""


@pytest.fixture(scope='module')
def started():
    """By script: its exit code, and what it said."""
    command = [sys.executable, '-c', START_ALL, *map(str, SCRIPTS)]
    ended = subprocess.run(command, capture_output=True, text=True, check=False)
    assert ended.returncode == 0, ended.stderr
    return json.loads(ended.stdout)


@pytest.mark.parametrize('script', SCRIPTS, ids=lambda path: path.stem)
def test_a_benchmark_prints_its_usage(script, started):
    """Truth: argparse, which prints the name of the script after `usage:`."""
    code, said = started[str(script)]
    assert code in {0, None}, said
    assert said.startswith(f'usage: {script.name}')
