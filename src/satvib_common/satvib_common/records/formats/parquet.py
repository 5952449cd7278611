# SPDX-FileCopyrightText: 2026 The satvib authors
# SPDX-License-Identifier: Apache-2.0
"""Parquet files, by pyarrow: a column is a channel, a unit stands in its metadata or in its name."""

from collections.abc import Callable, Iterator
from contextlib import ExitStack, contextmanager
from pathlib import Path
from typing import Any

import numpy as np

from satvib_common.records.formats.channels import Channel, Channels, scalars_of
from satvib_common.records.formats.kinds import PARQUET, check_size, needs, one_line


@contextmanager
def channels(path: Path, recover: bool = False) -> Iterator[Channels]:
    """List the columns of a file; they can be loaded inside the `with`.

    Raises:
        SatvibError: pyarrow is missing, or the file is damaged.
    """
    del recover  # what is where stands at the end of the file
    with needs(path, PARQUET.what, 'pyarrow'):
        import pyarrow as arrow
        from pyarrow import parquet
    with ExitStack() as stack:
        with one_line(path, PARQUET.what):
            file = stack.enter_context(parquet.ParquetFile(path))
            schema, rows = file.schema_arrow, file.metadata.num_rows
            check_size(path, 'a column', 8 * rows)
            stated = {_text(k): _text(v) for k, v in (schema.metadata or {}).items()}
            twice = {name for name in schema.names if schema.names.count(name) > 1}
            found = [_channel(path, arrow, file, item, rows, item.name in twice) for item in schema]
        yield Channels(found, scalars_of({k: v for k, v in stated.items() if len(v) < 40}))


def _channel(path: Path, arrow: Any, file: Any, item: Any, rows: int, twice: bool) -> Channel:
    about = {_text(k).lower(): _text(v) for k, v in (item.metadata or {}).items()}
    kinds = arrow.types
    good = any(
        is_kind(item.type)
        for is_kind in (kinds.is_integer, kinds.is_floating, kinds.is_boolean, kinds.is_decimal,
                        kinds.is_timestamp, kinds.is_duration)
    )  # fmt: skip
    reason = '' if good else f'holds {item.type}, not numbers'
    reason = 'its name occurs twice' if twice else reason
    return Channel(
        name=item.name,
        short=item.name,
        size=rows,
        load=_loader(path, arrow, file, item),
        unit=about.get('unit') or about.get('units') or '',
        reason=reason,
    )


def _loader(path: Path, arrow: Any, file: Any, item: Any) -> Callable[[], Any]:
    def load() -> Any:
        with one_line(path, PARQUET.what, f'column {item.name}'):
            column = file.read(columns=[item.name]).column(0)
            if arrow.types.is_timestamp(item.type):
                values = column.cast(arrow.timestamp(item.type.unit)).to_numpy()
            elif arrow.types.is_duration(item.type):
                values = column.to_numpy()
            else:
                return column.cast(arrow.float64(), safe=False).to_numpy()
            return np.asarray(values)

    return load


def _text(value: bytes) -> str:
    return value.decode('utf-8', 'replace')
