# SPDX-FileCopyrightText: 2026 The satvib authors
# SPDX-License-Identifier: Apache-2.0
"""A model of a whole measured record: orders and delays compared, and whether the model may be trusted."""

from typing import TYPE_CHECKING

from satvib_common.door import door

if TYPE_CHECKING:
    from satvib_ident.offline.delay import DelaySearch, find_delay
    from satvib_ident.offline.order_search import identify
    from satvib_ident.offline.plots import save_plots
    from satvib_ident.offline.residuals import ResidualTests, residual_tests
    from satvib_ident.offline.result import Candidate, Finding, Found, OfflineResult, Offset

__all__ = [
    'Candidate',
    'DelaySearch',
    'Finding',
    'Found',
    'OfflineResult',
    'Offset',
    'ResidualTests',
    'find_delay',
    'identify',
    'residual_tests',
    'save_plots',
]
__getattr__, __dir__ = door(__name__, __file__)
