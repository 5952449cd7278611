# SPDX-FileCopyrightText: 2026 The satvib authors
# SPDX-License-Identifier: Apache-2.0
"""A graph on several machines, which are network namespaces: the short form of benchmarks/machines.py.

Truth: the bag of the run, in which every sample says what the coil got before it.
"""

import json
import math
import subprocess
import sys
from pathlib import Path

import network
import pytest

ROOT = Path(__file__).resolve().parents[1]
TIMEOUT = 0.6  # s, command_timeout: this machine does other things too
WHY_NOT = network.missing()
pytestmark = [
    pytest.mark.skipif(bool(WHY_NOT), reason=WHY_NOT or 'none'),
    pytest.mark.usefixtures('domain'),
    pytest.mark.timeout(600),
]


def figures(case, *more):
    """Run one case; gives its figures by name."""
    words = [
        ROOT / 'benchmarks' / 'machines.py',
        '--only',
        case,
        '--timeout',
        str(TIMEOUT),
        '--json',
        *more,
    ]
    done = subprocess.run(
        [sys.executable, *map(str, words)], capture_output=True, text=True, check=False, timeout=500
    )
    assert done.returncode == 0, done.stderr
    ((_, found),) = json.loads(done.stdout.splitlines()[-1]).items()
    return found


@pytest.mark.parametrize(
    'way',
    ['static peers', *(pytest.param(w, marks=pytest.mark.long) for w in ('multicast', 'server'))],
)
def test_nodes_on_other_machines_find_each_other(way):
    """Every strut's voltages cross the network; a few may be missing, where this machine is busy."""
    found = figures(way, '--seconds', '5')
    assert found['missing'] < 0.2
    assert 0.0 < found['peak'] <= 20.0


@pytest.mark.long
def test_a_strut_without_network_is_at_0_v_and_comes_back():
    """0 V once `command_timeout` is over, for as long as the cable is out; then the law acts again, by itself."""
    found = figures('3 s')
    assert TIMEOUT - 0.1 < found['zero'] < TIMEOUT + 0.5
    assert found['at_zero'] > 0.6
    assert math.isfinite(found['back'])
    assert found['others'] == 0
    assert found['peak'] <= 20.0


@pytest.mark.long
def test_frames_that_are_lost_are_sent_again():
    """1 % of the frames both ways: no strut is at 0 V for long, and no other notices."""
    found = figures('1 %')
    assert found['at_zero'] < 0.1
    assert found['missing'] < 0.05
    assert found['others'] == 0
