# SPDX-FileCopyrightText: 2026 The satvib authors
# SPDX-License-Identifier: Apache-2.0
"""What a run of some length needs, told before it starts."""

import os

from satvib_common.errors import SatvibError
from satvib_plant_sim.rig.any_rig import AnyRig, strut_count
from satvib_plant_sim.rig.rig import Rig

# numbers per sample and strut of a recording, besides the truth on the fine grid: at least so many
_NUMBERS = 40
_BYTES = 8


def needed_bytes(samples: int, rig: AnyRig) -> int:
    """Memory of a run's recording, at least: both plates on the fine grid, and what the nodes publish."""
    fine = rig.acquisition.fine_steps if isinstance(rig, Rig) else 1
    return samples * strut_count(rig) * _BYTES * (2 * fine + _NUMBERS)


def check_memory(samples: int, rig: AnyRig) -> None:
    """Refuse a run whose recording does not fit into this machine's memory.

    Raises:
        SatvibError: it does not.
    """
    needed = needed_bytes(samples, rig)
    present = os.sysconf('SC_PHYS_PAGES') * os.sysconf('SC_PAGE_SIZE')
    if needed > present:
        raise SatvibError(
            f'duration: {samples:.6g} samples need {needed / 1e9:.3g} GB of memory, this machine has '
            f'{present / 1e9:.3g} GB'
        )
