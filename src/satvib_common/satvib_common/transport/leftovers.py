# SPDX-FileCopyrightText: 2026 The satvib authors
# SPDX-License-Identifier: Apache-2.0
"""Removes the shared memory that killed nodes have left.

Fast DDS gives every participant a segment of half a megabyte, a file `fastrtps_<16 hexadecimal digits>`, and holds a
lock on the file `..._el` beside it as long as the process lives. A process that is killed leaves both, and nothing
removes them before the machine starts again. `fastdds shm clean` looks at the lock in the same way.
"""

import contextlib
import fcntl
import os
import re
import time
from pathlib import Path

SHARED = Path('/dev/shm')  # noqa: S108 - where Fast DDS puts them
_LOCK = re.compile(r'fastrtps_[0-9a-f]{16}_el')
_YOUNG = 1.0  # s; a process that starts makes the file first and locks it then


def remove_leftovers(folder: Path = SHARED) -> int:
    """Remove the segments of this user that no living process holds; gives their number."""
    if not folder.is_dir():
        return 0
    with os.scandir(folder) as entries:
        locks = [folder / entry.name for entry in entries if _LOCK.fullmatch(entry.name)]
    return sum(_remove_unless_held(lock) for lock in locks)


def _remove_unless_held(lock: Path) -> bool:
    with contextlib.suppress(OSError):
        found = lock.stat()
        if found.st_uid != os.getuid() or time.time() - found.st_ctime < _YOUNG:
            return False
        with lock.open('rb') as file:
            fcntl.flock(file, fcntl.LOCK_EX | fcntl.LOCK_NB)
            lock.with_name(lock.name.removesuffix('_el')).unlink(missing_ok=True)
            lock.unlink(missing_ok=True)
            return True
    return False
