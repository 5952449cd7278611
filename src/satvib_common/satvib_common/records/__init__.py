# SPDX-FileCopyrightText: 2026 The satvib authors
# SPDX-License-Identifier: Apache-2.0
"""Measured records from text files of any layout: read, checked, with gaps where samples are missing."""

from typing import TYPE_CHECKING

from satvib_common.door import door

if TYPE_CHECKING:
    from satvib_common.records.checks import check_signal
    from satvib_common.records.layout import Reading
    from satvib_common.records.record import MeasuredRecord, is_text, text_record
    from satvib_common.records.text_table import TextTable, read_table

__all__ = [
    'MeasuredRecord',
    'Reading',
    'TextTable',
    'check_signal',
    'is_text',
    'read_table',
    'text_record',
]
__getattr__, __dir__ = door(__name__, __file__)
