# SPDX-FileCopyrightText: 2026 The satvib authors
# SPDX-License-Identifier: Apache-2.0
"""One process at a time compiles: mixed caches of two processes crash when called."""

import fcntl
import hashlib
import os
import tempfile
from pathlib import Path

import pytest

from satvib_common import kernel as module


def test_a_kernel_is_compiled_under_the_lock_of_its_file(monkeypatch):
    """Truth: a second handle on the lock file is refused while guvectorize runs, and granted afterwards."""
    source = hashlib.sha256(os.path.realpath(__file__).encode()).hexdigest()[:16]
    path = Path(tempfile.gettempdir()) / f'satvib-kernel-{os.getuid()}-{source}.lock'
    seen = []

    def compiler(*_args, **_options):
        def compiled(function):
            with path.open('a') as handle, pytest.raises(BlockingIOError):
                fcntl.flock(handle, fcntl.LOCK_EX | fcntl.LOCK_NB)
            seen.append(function.__name__)
            return function

        return compiled

    monkeypatch.setattr(module, 'guvectorize', compiler)

    @module.kernel('void(f8, f8[:])', '()->()')
    def twice(x, y):
        y[0] = 2.0 * x

    assert seen == ['twice']
    with path.open('a') as handle:
        fcntl.flock(handle, fcntl.LOCK_EX | fcntl.LOCK_NB)


def test_without_a_place_for_locks_a_kernel_is_compiled_all_the_same(monkeypatch):
    """Truth: 2 * 1.5 = 3 exactly, with a folder for temporary files that does not exist."""
    monkeypatch.setattr(tempfile, 'tempdir', '/nowhere/at/all')

    @module.kernel('void(f8, f8[:])', '()->()')
    def twice(x, y):
        y[0] = 2.0 * x

    assert float(twice(1.5)) == 3.0


def test_one_file_has_one_lock_by_whatever_path_it_is_imported(tmp_path):
    """Truth: with the lock held through the file, a handle on the lock's name through a link is refused.

    A workspace built with links imports one file by two paths, and has one cache for both.
    """
    (tmp_path / 'real').mkdir()
    (tmp_path / 'link').symlink_to(tmp_path / 'real')
    real = os.path.realpath(tmp_path / 'link' / 'x.py')
    name = hashlib.sha256(real.encode()).hexdigest()[:16]
    path = Path(tempfile.gettempdir()) / f'satvib-kernel-{os.getuid()}-{name}.lock'
    for folder in ('real', 'link'):
        with (
            module._alone(str(tmp_path / folder / 'x.py')),
            path.open('a') as handle,
            pytest.raises(BlockingIOError),
        ):
            fcntl.flock(handle, fcntl.LOCK_EX | fcntl.LOCK_NB)
