# SPDX-FileCopyrightText: 2026 The satvib authors
# SPDX-License-Identifier: Apache-2.0
"""What a disturbance says about its tones and its beginning."""

from satvib_plant_sim.disturbance.base import Disturbance


def disturbance_tones(disturbance: Disturbance) -> list[float]:
    """Fixed frequencies, Hz, increasing; empty for a disturbance without any."""
    return sorted({f for part in disturbance.parts() for f in part.tones()})


def disturbance_onset(disturbance: Disturbance) -> float:
    """When the first part begins, s."""
    return min((part.start for part in disturbance.parts()), default=0.0)
