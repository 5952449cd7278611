# SPDX-FileCopyrightText: 2026 The satvib authors
# SPDX-License-Identifier: Apache-2.0
"""How a process of the loop runs: no garbage collection in the loop, its own processor, its own priority."""

import contextlib
import gc
import os
from collections.abc import Callable
from pathlib import Path

_MIDDLEWARE = b'dds.'  # begin the names of the threads of Fast DDS


def settle_memory() -> None:
    """Collect once, exclude the objects that stay, and switch the collector off."""
    gc.collect()
    gc.freeze()
    gc.disable()


def tidy_memory() -> None:
    """Collect what has become garbage since, if the collector is off. It is cheap, because the rest is excluded."""
    if not gc.isenabled():
        gc.collect()


def set_niceness(niceness: int) -> None:
    """Let others go first: 0 to 19, of the threads of this process that compute. It needs no right.

    Those of the middleware keep their priority. They share locks with the processes that write to this one, so a writer
    would wait until a thread that is seldom let through has its turn: with niceness for them and other work on the
    machine the 99th percentile of the latency was three to five times as long.
    """
    if niceness <= 0:
        return
    for thread in _threads():
        with contextlib.suppress(OSError):  # it has ended meanwhile
            name = Path(f'/proc/self/task/{thread}/comm').read_bytes()
            if not name.startswith(_MIDDLEWARE):
                os.setpriority(os.PRIO_PROCESS, thread, niceness)


def _threads() -> list[int]:
    """All threads of this process: those of the middleware carry the messages."""
    return [int(path.name) for path in Path('/proc/self/task').iterdir()]


def set_processor(cpu: int, warn: Callable[[str], object]) -> None:
    """Stay on one processor; -1: any. Warns when that is not possible."""
    if cpu < 0:
        return
    try:
        for thread in _threads():
            os.sched_setaffinity(thread, {cpu})
    except OSError as error:
        warn(f'cpu {cpu}: not possible here ({error.strerror}); running on any')


def set_priority(priority: int, warn: Callable[[str], object]) -> None:
    """Run under SCHED_FIFO with a priority of 1 to 99; 0: the ordinary scheduler. Warns when not permitted."""
    if priority <= 0:
        return
    try:
        for thread in _threads():
            os.sched_setscheduler(thread, os.SCHED_FIFO, os.sched_param(priority))
    except OSError as error:
        warn(
            f'priority {priority}: not permitted ({error.strerror}); running with the ordinary '
            'scheduler. Allow it with an rtprio line in /etc/security/limits.conf'
        )
