# SPDX-FileCopyrightText: 2026 The satvib authors
# SPDX-License-Identifier: Apache-2.0
"""Trials as a table: one row each, with number, seed, what was drawn (`p:<key>`) and the figures; to and from Parquet.

The bytes of a file depend on the rows alone: columns in a fixed order, no time, no machine, one writer's settings.
"""

from __future__ import annotations

import io
import json
from collections.abc import Sequence
from typing import Any

import numpy as np
import pyarrow as pa
import pyarrow.parquet as pq
from numpy.typing import NDArray

from satvib_studies.campaign.trials import TrialPlan

PARAMETER = 'p:'
ROWS = 16384  # of a row group


def make_table(plan: TrialPlan, first: int, columns: dict[str, NDArray[Any]]) -> pa.Table:
    """Make the table of some consecutive trials.

    Args:
        plan: of these trials alone.
        first: number of the first in the campaign.
        columns: figures by name, (trials).
    """
    count = len(plan.seeds)
    arrays: dict[str, pa.Array] = {
        'trial': pa.array(np.arange(first, first + count), pa.int64()),
        'seed': pa.array(plan.seeds, pa.int64()),
    }
    for key, drawn in plan.values.items():
        arrays[PARAMETER + key] = _drawn(drawn)
    for name, values in columns.items():
        kind = pa.string() if values.dtype.kind == 'O' else None
        arrays[name] = pa.array(values, kind)
    return pa.table(arrays)


def _drawn(values: Sequence[Any]) -> pa.Array:
    """Numbers as numbers, anything else as the text that --set takes."""
    if all(isinstance(v, int | float) and not isinstance(v, bool) for v in values):
        return pa.array([float(v) for v in values], pa.float64())
    return pa.array([json.dumps(v) for v in values], pa.string())


def to_bytes(table: pa.Table) -> bytes:
    """Give the Parquet file of a table."""
    sink = io.BytesIO()
    pq.write_table(
        table.combine_chunks(), sink, row_group_size=ROWS, compression='zstd', version='2.6'
    )
    return sink.getvalue()


def from_bytes(data: bytes) -> pa.Table:
    """Read a Parquet file.

    Raises:
        pyarrow.ArrowInvalid: it is none.
    """
    # without Arrow's threads: one that is still at work when the process ends aborts it (apache/arrow issue 34314)
    return pq.ParquetFile(pa.BufferReader(data)).read(use_threads=False)


def joined(tables: Sequence[pa.Table]) -> pa.Table:
    """Join the parts of a campaign; a column that a part lacks (all its trials failed) is empty there."""
    fullest = max(tables, key=lambda table: table.num_columns)
    return pa.concat_tables([_completed(table, fullest.schema) for table in tables])


def _completed(table: pa.Table, schema: pa.Schema) -> pa.Table:
    """Give a table the columns of another, in its order."""
    arrays = []
    for field in schema:
        if field.name in table.column_names:
            arrays.append(table[field.name].cast(field.type))
        elif pa.types.is_floating(field.type):
            arrays.append(pa.array(np.full(table.num_rows, np.nan), field.type))
        elif pa.types.is_integer(field.type):
            arrays.append(pa.array(np.zeros(table.num_rows, dtype=np.int64)).cast(field.type))
        else:
            arrays.append(pa.array([''] * table.num_rows, field.type))
    return pa.table(arrays, schema=schema)
