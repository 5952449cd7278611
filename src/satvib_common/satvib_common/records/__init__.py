# SPDX-FileCopyrightText: 2026 The satvib authors
# SPDX-License-Identifier: Apache-2.0
"""Measured records from files of any format: read, checked, with gaps where samples are missing."""

from typing import TYPE_CHECKING

from satvib_common.door import door

if TYPE_CHECKING:
    from satvib_common.records.any_file import has_columns, list_columns, read_table
    from satvib_common.records.checks import check_signal
    from satvib_common.records.layout import Reading
    from satvib_common.records.record import (
        Column,
        MeasuredColumns,
        MeasuredRecord,
        column_record,
        read_columns,
    )
    from satvib_common.records.table import Table
    from satvib_common.records.units import ACCELERATION, VOLTAGE, Quantity

__all__ = [
    'ACCELERATION',
    'VOLTAGE',
    'Column',
    'MeasuredColumns',
    'MeasuredRecord',
    'Quantity',
    'Reading',
    'Table',
    'check_signal',
    'column_record',
    'has_columns',
    'list_columns',
    'read_columns',
    'read_table',
]
__getattr__, __dir__ = door(__name__, __file__)
