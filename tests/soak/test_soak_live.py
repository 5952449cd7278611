# SPDX-FileCopyrightText: 2026 The satvib authors
# SPDX-License-Identifier: Apache-2.0
"""Long runs lose nothing and do not grow; benchmarks/soak.py runs them for an hour.

Truth: the recording, and /proc. Allowed is what a history may still take in, and besides `_LEAK` for each sample and
process: less than the smallest leak there is, one Python object for each sample, which has 16 bytes and its place in a
list. The readings have pages of 4 kB, and an allocator keeps some of what was freed: that is `_NOISE`. Two processes
have buffers that may be empty or full when they are read, `_BUFFERS`: the plant 1000 messages of truth of up to 2 kB,
the recorder a chunk of 1 MB of the bag and its copy on the way to the disk, and what comes within `_AWAY` while a busy
machine gives it no turn.
"""

import pytest
from soaking import soak

_LEAK = 24.0  # bytes a sample
_NOISE = 0.5  # MB
_BUFFERS = {'plant_sim': 2.0, 'recorder': 2.0}  # MB
_AWAY = 1.0  # s


def check(found):
    """What holds on any machine."""
    outcome = found.outcome
    limit = _NOISE + _LEAK * outcome['samples'] / 2**20
    coming = max(found.speed) * outcome['bag'] / outcome['samples'] / 2**20
    buffers = _BUFFERS | {'recorder': _BUFFERS['recorder'] + _AWAY * coming}
    assert outcome['success'], outcome['message']
    assert outcome['lost'] == 0
    assert len(found.processes) >= 4
    for name, growth in found.processes.items():
        first, last = growth.first, growth.last
        print(name, growth)
        assert last.descriptors == first.descriptors, name
        assert last.shared == 0, name
        assert growth.grown < limit + buffers.get(name, 0.0), name


@pytest.mark.usefixtures('domain')
def test_a_short_run_in_lockstep_does_not_grow(tmp_path):
    """One strut at 50 Hz, 3000 samples, or as many as ten readings take; the last history is full after 2000."""
    for minutes in (1, 3, 9):
        settings = [f'duration={60 * minutes}', 'rig.acquisition.sample_rate=50', 'analysis={}']
        folder = tmp_path / f'soak-{minutes}'
        found = soak('paper_1dof_10hz', settings, folder, realtime=False, every=50 * minutes)
        if found.processes:
            break
    check(found)


@pytest.mark.long
@pytest.mark.timeout(900)
@pytest.mark.usefixtures('domain')
@pytest.mark.parametrize('realtime', [True, False])
def test_three_minutes_do_not_grow(tmp_path, realtime):
    """Three struts at 200 Hz; histories are full after 50 s, which is in the first third."""
    settings = ['duration=180', 'rig.acquisition.sample_rate=200', 'analysis={}']
    found = soak('soft_3dof', settings, tmp_path / 'soak', realtime)
    check(found)
