# SPDX-FileCopyrightText: 2026 The satvib authors
# SPDX-License-Identifier: Apache-2.0
"""The report of a run: figures, one self-contained HTML page, and result.json for machines."""

from typing import TYPE_CHECKING

from satvib_common.door import door

if TYPE_CHECKING:
    from satvib_experiment.report.build import Report, write_report
    from satvib_experiment.report.context import Context
    from satvib_experiment.report.result import result_mapping

__all__ = [
    'Context',
    'Report',
    'result_mapping',
    'write_report',
]
__getattr__, __dir__ = door(__name__, __file__)
