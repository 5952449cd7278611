# SPDX-FileCopyrightText: 2026 The satvib authors
# SPDX-License-Identifier: Apache-2.0
"""One set-up at a time."""

import contextlib
import fcntl
from collections.abc import Iterator

from workspace.base import CACHE, INHERITED, say


@contextlib.contextmanager
def alone() -> Iterator[None]:
    """Let one set-up at a time work on the workspace; a second terminal waits for the first.

    The commands of a set-up inherit the lock. When only the set-up itself was killed, the next one waits until the
    command that was left has ended, and never writes into the same files.
    """
    CACHE.mkdir(exist_ok=True)
    with (CACHE / 'lock').open('w') as lock:
        try:
            fcntl.flock(lock, fcntl.LOCK_EX | fcntl.LOCK_NB)
        except BlockingIOError:
            say('another set-up is at work here; waiting for it')
            fcntl.flock(lock, fcntl.LOCK_EX)
        INHERITED[:] = [lock.fileno()]
        try:
            yield
        finally:
            INHERITED.clear()
