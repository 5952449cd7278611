# SPDX-FileCopyrightText: 2026 The satvib authors
# SPDX-License-Identifier: Apache-2.0
"""Identification from a record: search for the order, residual tests, plots."""

from typing import TYPE_CHECKING

from satvib_common.door import door

if TYPE_CHECKING:
    from satvib_ident.offline.order_search import Candidate, OfflineResult, identify
    from satvib_ident.offline.plots import save_plots
    from satvib_ident.offline.residuals import residual_tests

__all__ = [
    'Candidate',
    'OfflineResult',
    'identify',
    'residual_tests',
    'save_plots',
]
__getattr__, __dir__ = door(__name__, __file__)
