# SPDX-FileCopyrightText: 2026 The satvib authors
# SPDX-License-Identifier: Apache-2.0
"""Gains of the centralized law, found by a particle swarm on a set of perturbed plants."""

from typing import TYPE_CHECKING

from satvib_common.door import door

if TYPE_CHECKING:
    from satvib_studies.tuning.cost import CostSettings, TuningCost
    from satvib_studies.tuning.particle_swarm import ParticleSwarm, SwarmResult, SwarmSettings
    from satvib_studies.tuning.search import Search, Tuned, TuneSettings, write_gains

__all__ = [
    'CostSettings',
    'ParticleSwarm',
    'Search',
    'SwarmResult',
    'SwarmSettings',
    'TuneSettings',
    'Tuned',
    'TuningCost',
    'write_gains',
]
__getattr__, __dir__ = door(__name__, __file__)
