# SPDX-FileCopyrightText: 2026 The satvib authors
# SPDX-License-Identifier: Apache-2.0
"""Measured records from text files and bags: read, checked, with the gaps where samples are missing."""

from typing import TYPE_CHECKING

from satvib_common.door import door

if TYPE_CHECKING:
    from satvib_experiment.records.layout import Reading
    from satvib_experiment.records.record import MeasuredRecord, bag_record, is_text, text_record
    from satvib_experiment.records.text_table import TextTable, read_table

__all__ = ['MeasuredRecord', 'Reading', 'TextTable', 'bag_record', 'is_text', 'read_table', 'text_record']
__getattr__, __dir__ = door(__name__, __file__)
