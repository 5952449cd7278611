# SPDX-FileCopyrightText: 2026 The satvib authors
# SPDX-License-Identifier: Apache-2.0
"""What a run of some length needs, told before it starts."""

from satvib_common.needs import check_needs
from satvib_plant_sim.rig.any_rig import AnyRig, strut_count
from satvib_plant_sim.rig.rig import Rig

# numbers per sample and strut of a recording, besides the truth on the fine grid: at least so many
_NUMBERS = 40
_BYTES = 8
STEP_TIME = 2e-6  # s of a processor for a sample of a trial, at least


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
