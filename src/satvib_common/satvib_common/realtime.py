# SPDX-FileCopyrightText: 2026 The satvib authors
# SPDX-License-Identifier: Apache-2.0
"""How a process of the loop runs: no garbage collection in the loop, its own processor, its own priority."""

import gc
import os
from collections.abc import Callable


def settle_memory() -> None:
    """Collect once, exclude the objects that stay, and switch the collector off."""
    gc.collect()
    gc.freeze()
    gc.disable()


def tidy_memory() -> None:
    """Collect what has become garbage since, if the collector is off. It is cheap, because the rest is excluded."""
    if not gc.isenabled():
        gc.collect()


def set_processor(cpu: int, warn: Callable[[str], object]) -> None:
    """Stay on one processor; -1: any. Warns when that is not possible."""
    if cpu < 0:
        return
    try:
        os.sched_setaffinity(0, {cpu})
    except OSError as error:
        warn(f'cpu {cpu}: not possible here ({error.strerror}); running on any')


def set_priority(priority: int, warn: Callable[[str], object]) -> None:
    """Run under SCHED_FIFO with a priority of 1 to 99; 0: the ordinary scheduler. Warns when not permitted."""
    if priority <= 0:
        return
    try:
        os.sched_setscheduler(0, os.SCHED_FIFO, os.sched_param(priority))
    except OSError as error:
        warn(
            f'priority {priority}: not permitted ({error.strerror}); running with the ordinary '
            'scheduler. Allow it with an rtprio line in /etc/security/limits.conf'
        )
