# SPDX-FileCopyrightText: 2026 The satvib authors
# SPDX-License-Identifier: Apache-2.0
"""Shared memory of processes that were killed. Truth: the locks of this process, on files like those of Fast DDS."""

import fcntl

from satvib_common.transport import leftovers
from satvib_common.transport.leftovers import remove_leftovers


def segment(folder, number):
    """A segment and its lock, made long ago as far as the module looks; gives their names."""
    name = f'fastrtps_{number:016x}'
    for path in (folder / name, folder / f'{name}_el'):
        path.write_bytes(b'')
    return {name, f'{name}_el'}


def test_what_nobody_holds_is_removed_and_nothing_else(tmp_path, monkeypatch):
    monkeypatch.setattr(leftovers, '_YOUNG', 0.0)
    segment(tmp_path, 1)
    held = segment(tmp_path, 2)
    others = {'fastrtps_port7411_el', 'fastrtps_port7411', 'fastrtps_00', 'else_el'}
    for name in others:
        (tmp_path / name).write_bytes(b'')
    with (tmp_path / min(held, key=lambda n: not n.endswith('_el'))).open('rb') as lock:
        fcntl.flock(lock, fcntl.LOCK_EX)
        assert remove_leftovers(tmp_path) == 1
        assert {p.name for p in tmp_path.iterdir()} == held | others
    assert remove_leftovers(tmp_path) == 1
    assert {p.name for p in tmp_path.iterdir()} == others
    assert remove_leftovers(tmp_path / 'nowhere') == 0


def test_a_file_that_was_just_made_is_left(tmp_path):
    """Its process may not have locked it yet."""
    made = segment(tmp_path, 3)
    assert remove_leftovers(tmp_path) == 0
    assert {p.name for p in tmp_path.iterdir()} == made
