# SPDX-FileCopyrightText: 2026 The satvib authors
# SPDX-License-Identifier: Apache-2.0
"""One set-up at a time."""

import contextlib
import fcntl
import time
from collections.abc import Iterator
from typing import TextIO

from workspace.base import CACHE, INHERITED, say

_LOOK = (
    2.0  # s; every command looks whether something is missing, and holds the lock for that moment
)


@contextlib.contextmanager
def alone() -> Iterator[None]:
    """Let one set-up at a time work on the workspace; a second terminal waits for the first.

    The commands of a set-up inherit the lock. When only the set-up itself was killed, the next one waits until the
    command that was left has ended, and never writes into the same files.
    """
    CACHE.mkdir(exist_ok=True)
    with (CACHE / 'lock').open('w') as lock:
        if not _is_free(lock):
            say('another set-up is at work here; waiting for it')
            fcntl.flock(lock, fcntl.LOCK_EX)
        INHERITED[:] = [lock.fileno()]
        try:
            yield
        finally:
            INHERITED.clear()


def _is_free(lock: TextIO) -> bool:
    """Take the lock, unless another one holds it for longer than a look takes."""
    until = time.monotonic() + _LOOK
    while time.monotonic() < until:
        with contextlib.suppress(BlockingIOError):
            fcntl.flock(lock, fcntl.LOCK_EX | fcntl.LOCK_NB)
            return True
        time.sleep(0.05)
    return False
