# SPDX-FileCopyrightText: 2026 The satvib authors
# SPDX-License-Identifier: Apache-2.0
"""What a campaign measures of each trial, and which parameter it depends on."""

from typing import TYPE_CHECKING

from satvib_common.door import door

if TYPE_CHECKING:
    from satvib_studies.campaign.measures.metrics import TrialMetrics
    from satvib_studies.campaign.measures.sensitivity import Sensitivity, ranking

__all__ = [
    'Sensitivity',
    'TrialMetrics',
    'ranking',
]
__getattr__, __dir__ = door(__name__, __file__)
