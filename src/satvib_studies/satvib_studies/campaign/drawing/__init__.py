# SPDX-FileCopyrightText: 2026 The satvib authors
# SPDX-License-Identifier: Apache-2.0
"""What the trials of a campaign draw: distributions, and points spread over them."""

from typing import TYPE_CHECKING

from satvib_common.door import door

if TYPE_CHECKING:
    from satvib_studies.campaign.drawing.distribution import Distribution
    from satvib_studies.campaign.drawing.sampling import draw, unit_points

__all__ = [
    'Distribution',
    'draw',
    'unit_points',
]
__getattr__, __dir__ = door(__name__, __file__)
