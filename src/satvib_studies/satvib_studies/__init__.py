# SPDX-FileCopyrightText: 2026 The satvib authors
# SPDX-License-Identifier: Apache-2.0
"""Studies of many simulated runs: campaigns, comparisons, tuning, sweeps, and the study of signals."""

from typing import TYPE_CHECKING

from satvib_common.door import door

if TYPE_CHECKING:
    from satvib_studies.campaign.run import begin, go_on, resume
    from satvib_studies.campaign.settings import Campaign, load_campaign
    from satvib_studies.comparison.cases import Comparison, load_comparison
    from satvib_studies.comparison.runs import run_comparison
    from satvib_studies.sweep.sweep import Sweep, load_sweep, run_sweep
    from satvib_studies.tuning.particle_swarm import ParticleSwarm, SwarmSettings
    from satvib_studies.tuning.search import Search, TuneSettings

__all__ = [
    'Campaign',
    'Comparison',
    'ParticleSwarm',
    'Search',
    'SwarmSettings',
    'Sweep',
    'TuneSettings',
    'begin',
    'go_on',
    'load_campaign',
    'load_comparison',
    'load_sweep',
    'resume',
    'run_comparison',
    'run_sweep',
]
__getattr__, __dir__ = door(__name__, __file__)
