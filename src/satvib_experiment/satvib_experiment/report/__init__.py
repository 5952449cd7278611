# SPDX-FileCopyrightText: 2026 The satvib authors
# SPDX-License-Identifier: Apache-2.0
"""The report of a run: figures, one self-contained HTML page, and result.json for machines."""

from satvib_experiment.report.build import write_report

__all__ = ['write_report']
