# SPDX-FileCopyrightText: 2026 The satvib authors
# SPDX-License-Identifier: Apache-2.0
"""MATLAB files up to version 7 (.mat), by scipy.io; structures and cells are walked through by name.

A field is `run.u`, a column of a matrix `data:2`, an element of a structure array `Y:2.Data`. Tables, timetables and
strings are objects whose layout is not published: they are named, not read.
"""

import functools
import math
import struct
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any

import numpy as np

from satvib_common.errors import SatvibError
from satvib_common.records.formats.arrays import DEEPEST, OBJECT, array_channels
from satvib_common.records.formats.channels import Channel, Channels, scalars_of
from satvib_common.records.formats.kinds import MATLAB, check_size, one_line

_HEADER = 128  # bytes before the first variable
_OBJECTS = frozenset({'opaque', 'function', 'object'})
_TREES = frozenset({'struct', 'cell'})
_SKIPPED = frozenset({'char', 'unknown'})


@contextmanager
def channels(path: Path, recover: bool = False) -> Iterator[Channels]:
    """List the channels of a file; they can be loaded inside the `with`.

    Raises:
        SatvibError: the file is damaged.
    """
    from scipy.io import whosmat

    del recover  # a compressed variable that is cut cannot be read
    found = Channels([])
    pairs: dict[str, Any] = {}
    _check_whole(path)
    with one_line(path, MATLAB.what):
        with path.open('rb') as source:
            variables = whosmat(source)
        for name, shape, kind in variables:
            check_size(path, name, 8 * math.prod(shape))
            load = functools.partial(_load, path, name)
            if kind in _OBJECTS:
                found.found.append(Channel(name=name, size=0, load=list, reason=OBJECT))
            elif kind in _TREES or (math.prod(shape) == 1 and kind not in _SKIPPED):
                _walk(found, pairs, name, '', load())
            elif kind == 'char':
                found.texts.append(name)
            elif kind not in _SKIPPED:
                reason = 'a sparse matrix' if kind == 'sparse' else ''
                found.found += array_channels(name, '', shape, load, short=name, reason=reason)
    found.scalars = scalars_of(pairs)
    yield found


def _check_whole(path: Path) -> None:
    """Walk over the variables of a file of version 5 to 7: each states its bytes, and the last one ends the file.

    Raises:
        SatvibError: the file is cut, or a length is damaged.
    """
    size = path.stat().st_size
    with path.open('rb') as source:
        order = {b'IM': '<', b'MI': '>'}.get(source.read(_HEADER)[-2:])
        at = _HEADER
        while order and at < size:
            source.seek(at)
            tag = source.read(8)
            at += 8 + (struct.unpack(f'{order}4xI', tag)[0] if len(tag) == 8 else size)
    if order and at != size:
        raise SatvibError(
            f'{path}: the file is cut, or the length of a variable is damaged: the last one ends at byte {at} of {size}'
        )


def _load(path: Path, name: str) -> Any:
    """Load one variable."""
    from scipy.io import loadmat

    with one_line(path, MATLAB.what, f'variable {name}'), path.open('rb') as source:
        return loadmat(source, variable_names=[name])[name]


def _walk(found: Channels, pairs: dict[str, Any], name: str, group: str, value: Any) -> None:
    """Add what is in a variable.

    Args:
        found: gets the channels.
        pairs: gets single numbers.
        name: of the variable.
        group: that it is in.
        value: of it: an array of numbers, of structures or of cells.
    """
    if name.count('.') > DEEPEST or not isinstance(value, np.ndarray):
        return
    kind = value.dtype.kind
    if value.dtype.names:  # structures
        for i, item in enumerate(value.reshape(-1)):
            own = name if value.size == 1 else f'{name}:{i + 1}'
            for key in value.dtype.names:
                _walk(found, pairs, f'{own}.{key}', own, item[key])
    elif kind == 'O':  # cells
        for i, item in enumerate(value.reshape(-1)):
            own = name if value.size == 1 else f'{name}:{i + 1}'
            _walk(found, pairs, own, group, item)
    elif value.size == 1 and kind in 'buif':
        pairs[name] = value.reshape(-1)[0]
    elif kind in 'US':
        found.texts.append(name)
    else:
        reason = '' if kind in 'buif' else f'holds {value.dtype}, not numbers'
        found.found += array_channels(
            name,
            group,
            value.shape,
            lambda: value,
            short=name.rpartition('.')[2],
            reason=reason,
        )
