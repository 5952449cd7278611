# SPDX-FileCopyrightText: 2026 The satvib authors
# SPDX-License-Identifier: Apache-2.0
"""What a computation would need, told before it starts: memory that is not there, time that nobody has."""

import os

from satvib_common.errors import SatvibError
from satvib_plant_sim.rig.any_rig import AnyRig, strut_count
from satvib_plant_sim.rig.rig import Rig

# numbers per sample and strut of a recording, besides the truth on the fine grid: at least so many
_NUMBERS = 40
_BYTES = 8
STEP_TIME = 2e-6  # s of a processor for a sample of a trial, at least

LONGEST = 30 * 86400.0  # s
_UNITS = ((86400.0 * 365.25, 'years'), (86400.0, 'days'), (3600.0, 'hours'))


def needed_bytes(samples: int, rig: AnyRig) -> int:
    """Memory of a run's recording, at least: both plates on the fine grid, and what the nodes publish."""
    fine = rig.acquisition.fine_steps if isinstance(rig, Rig) else 1
    return samples * strut_count(rig) * _BYTES * (2 * fine + _NUMBERS)


def check_memory(samples: int, rig: AnyRig) -> None:
    """Refuse a run whose recording does not fit into this machine's memory, or that would take a month.

    Raises:
        SatvibError: it does not.
    """
    check_needs(f'duration: {samples:.6g} samples', needed_bytes(samples, rig), samples * STEP_TIME)


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
