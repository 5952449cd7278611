# SPDX-FileCopyrightText: 2026 The satvib authors
# SPDX-License-Identifier: Apache-2.0
"""Reads recorded sensors: columns of a file, or the accelerations of a bag."""

import math
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

import numpy as np
from satvib_common.arrays import Array
from satvib_common.errors import SatvibError
from satvib_common.records.any_file import read_table
from satvib_common.records.units import ACCELERATION, VOLTAGE, scale_of

_SPARSEST = 1000  # samples for each message; what is lost in a run is far less


def read_file(path: Path, columns: Mapping[str, str], unit: str) -> Array:
    """Read the column of each channel.

    Args:
        path: file of columns of any format.
        columns: name of the column by name of the channel.
        unit: V or m/s^2, in which the columns are given; what the file says to be in g or mV is converted.

    Returns:
        (rows, channels) in the order of `columns`; NaN where a value is missing.

    Raises:
        SatvibError: no such file or column, a cell that is no number; the line is named.
    """
    quantity = VOLTAGE if unit == 'V' else ACCELERATION
    table = read_table(path, list(columns.values()))
    scales = [scale_of(said, quantity) or 1.0 for said in table.units]
    return np.stack([s * values for s, values in zip(scales, table.columns, strict=True)], axis=-1)


def read_bag(path: Path, channels: Sequence[str]) -> Array:
    """Read the accelerations of a bag.

    Args:
        path: folder of the bag, or its .mcap file.
        channels: names as in `strut_1.upper`.

    Returns:
        (samples, channels) m/s^2, from the first sequence to the last; NaN where a sample is missing.

    Raises:
        SatvibError: not a bag, or a strut that is not in it.
    """
    try:
        from rosbags.highlevel import AnyReader
    except ImportError:
        raise SatvibError(
            'back end replay: rosbags is missing; install it with: pip install rosbags'
        ) from None
    found: dict[str, dict[int, Any]] = {}
    try:
        with AnyReader([path]) as reader:
            wanted = [c for c in reader.connections if c.topic.endswith('/acceleration')]
            for connection, _, raw in reader.messages(wanted):
                message = reader.deserialize(raw, connection.msgtype)
                strut = connection.topic.strip('/').split('/')[-2]
                found.setdefault(strut, {})[int(message.sequence)] = message
    except Exception as error:  # a parser that meets damaged bytes raises anything  # noqa: BLE001
        said = ' '.join(str(error).split()) or type(error).__name__
        raise SatvibError(f'{path}: cannot be read as a bag: {said}') from None
    first = min((min(by) for by in found.values()), default=0)
    last = max((max(by) for by in found.values()), default=-1)
    rows, there = last + 1 - first, sum(len(by) for by in found.values())
    if rows > _SPARSEST * there:
        raise SatvibError(
            f'{path}: cannot be read as a bag: {there} accelerations of samples {first} to {last}; '
            'a sequence is damaged'
        )
    values = np.full((rows, len(channels)), math.nan)
    for i, channel in enumerate(channels):
        strut, _, plate = channel.partition('.')
        if strut not in found:
            known = ', '.join(sorted(found)) or 'none'
            raise SatvibError(f'{path}: no acceleration of {strut} (struts: {known})')
        for sequence, message in found[strut].items():
            values[sequence - first, i] = getattr(message, plate)
    return values
