# SPDX-FileCopyrightText: 2026 The satvib authors
# SPDX-License-Identifier: Apache-2.0
"""Campaigns: thousands of trials with drawn parameters, kept part by part, and their report."""

from typing import TYPE_CHECKING

from satvib_common.door import door

if TYPE_CHECKING:
    from satvib_studies.campaign.run import begin, go_on, resume
    from satvib_studies.campaign.settings import Campaign, campaign_names, load_campaign
    from satvib_studies.campaign.store import Store
    from satvib_studies.campaign.trials import TrialPlan, plan_trials

__all__ = [
    'Campaign',
    'Store',
    'TrialPlan',
    'begin',
    'campaign_names',
    'go_on',
    'load_campaign',
    'plan_trials',
    'resume',
]
__getattr__, __dir__ = door(__name__, __file__)
