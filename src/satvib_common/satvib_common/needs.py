# SPDX-FileCopyrightText: 2026 The satvib authors
# SPDX-License-Identifier: Apache-2.0
"""What a computation would need, told before it starts: memory that is not there, time that nobody has."""

import os

from satvib_common.errors import SatvibError

LONGEST = 30 * 86400.0  # s
_UNITS = ((86400.0 * 365.25, 'years'), (86400.0, 'days'), (3600.0, 'hours'))


def machine_memory() -> float:
    """Memory of this machine, bytes."""
    return float(os.sysconf('SC_PHYS_PAGES') * os.sysconf('SC_PAGE_SIZE'))


def check_needs(what: str, memory: float = 0.0, seconds: float = 0.0) -> None:
    """Refuse what needs more memory than this machine has, or more than 30 days.

    Args:
        what: is asked for, with its key: 'trials: 10000000 trials of 5000 samples'.
        memory: bytes, at least.
        seconds: of one processor, at least.

    Raises:
        SatvibError: it is too much.
    """
    present = machine_memory()
    if memory > present:
        raise SatvibError(
            f'{what} need {memory / 1e9:.3g} GB of memory, this machine has {present / 1e9:.3g} GB'
        )
    spread = seconds / (os.cpu_count() or 1)
    if spread > LONGEST:
        size, unit = next(u for u in _UNITS if spread >= u[0])
        raise SatvibError(
            f'{what} need at least {spread / size:.3g} {unit} on the {os.cpu_count()} processors of this machine'
        )
