# SPDX-FileCopyrightText: 2026 The satvib authors
# SPDX-License-Identifier: Apache-2.0
"""The report of a campaign: table, figures, page."""

from typing import TYPE_CHECKING

from satvib_common.door import door

if TYPE_CHECKING:
    from satvib_studies.campaign.report.page import summarize, write_report
    from satvib_studies.campaign.report.table import make_table

__all__ = [
    'make_table',
    'summarize',
    'write_report',
]
__getattr__, __dir__ = door(__name__, __file__)
