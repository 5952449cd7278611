# SPDX-FileCopyrightText: 2026 The satvib authors
# SPDX-License-Identifier: Apache-2.0
"""Universal files (.uff, .unv): time records of data set 58, as text or binary (58b), by pyuff.

A channel is the place and direction of its response, such as `12+Z`, or its first line of text where that tells it
from all others. Without a label for its unit, an acceleration is in the units of data set 164.

Source: Structural Dynamics Research Laboratory, University of Cincinnati, Universal File Formats 58 and 164.
"""

import re
from collections import Counter
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any

from satvib_common.errors import SatvibError, printable
from satvib_common.records.formats.channels import Channel, Channels
from satvib_common.records.formats.kinds import UNIVERSAL, check_size, needs, one_line

# as pyuff finds the lines around a data set; the data of a binary one end without a line end
_MARK = re.compile(rb'    -1(?=[\r\n]|$| {74})')
_FUNCTIONS = {
    0: 'a general function', 1: 'a time record', 2: 'an auto spectrum', 3: 'a cross spectrum',
    4: 'a frequency response', 6: 'a coherence', 9: 'a power spectral density', 12: 'a spectrum',
}  # fmt: skip
_DIRECTIONS = {
    0: '', 1: '+X', -1: '-X', 2: '+Y', -2: '-Y', 3: '+Z', -3: '-Z',
    4: '+RX', -4: '-RX', 5: '+RY', -5: '-RY', 6: '+RZ', -6: '-RZ',
}  # fmt: skip
_ACCELERATION = 12  # specific data type of an ordinate
_EVEN = 1  # spacing of the abscissa
_REAL = (2, 4)  # types of an ordinate, single and double
_SPARE = 4  # values that line ends behind a binary block may look like


@contextmanager
def channels(path: Path, recover: bool = False) -> Iterator[Channels]:
    """List the time records of a file; they can be loaded inside the `with`.

    Raises:
        SatvibError: pyuff is missing, or the file is damaged or cut.
    """
    del recover  # where a data set is cut is not known without its end
    with needs(path, UNIVERSAL.what, 'pyuff'):
        import pyuff
    with one_line(path, UNIVERSAL.what):
        marks = len(_MARK.findall(path.read_bytes()))
        if marks % 2:
            raise SatvibError(
                f'{path}: data set {marks // 2 + 1} has no end: the file is cut, or a line "    -1" is damaged'
            )
        file = pyuff.UFF(str(path))
        kinds = [int(kind) for kind in file.get_set_types()]
        headers = {}
        for i in (i for i, kind in enumerate(kinds) if kind in {58, 164}):
            with one_line(path, UNIVERSAL.what, f'data set {i + 1}'):
                headers[i] = file.read_sets(i, header_only=kinds[i] == 58)
        found = [_channel(path, file, i, headers) for i in headers if kinds[i] == 58]
    if not found:
        there = ', '.join(str(k) for k in sorted(set(kinds))) or 'none'
        raise SatvibError(f'{path}: holds no data set 58, in which records are, only {there}')
    yield Channels(_named(found))


def _channel(path: Path, file: Any, i: int, headers: dict[int, Any]) -> Channel:
    header = headers[i]
    size, kind = int(header['num_pts']), int(header['func_type'])
    check_size(path, f'data set {i + 1}', 8 * size)
    first = printable(header['id1'].strip())
    reason = ''
    if kind not in {0, 1}:
        reason = f'{_FUNCTIONS.get(kind, f"function {kind}")}, not a time record'
    elif header['ord_data_type'] not in _REAL:
        reason = 'its values are complex'
    even = header['abscissa_spacing'] == _EVEN
    return Channel(
        name=f'{header["rsp_node"]}{_DIRECTIONS.get(int(header["rsp_dir"]), "")}',
        short='' if first.upper() == 'NONE' else first,
        size=size,
        load=_loader(path, file, i, size, 'data'),
        unit=_unit(header, headers, i),
        period=float(header['abscissa_inc']) if even else 0.0,
        start=float(header['abscissa_min']) if even else 0.0,
        times=None if even else _loader(path, file, i, size, 'x'),
        reason=reason,
    )


def _loader(path: Path, file: Any, i: int, size: int, key: str) -> Callable[[], Any]:
    def load() -> Any:
        with one_line(path, UNIVERSAL.what, f'data set {i + 1}'):
            values = file.read_sets(i)[key]
            if not size <= len(values) <= size + _SPARE:
                raise SatvibError(
                    f'{path}: data set {i + 1} has {len(values)} values, its header says {size}: cut or damaged'
                )
            return values[:size]

    return load


def _unit(header: dict[str, Any], headers: dict[int, Any], i: int) -> str:
    label = str(header.get('ordinate_axis_units_lab', '')).strip()
    if label and label.upper() != 'NONE':
        return label
    # the nearest units before it hold; SI is the value in the file over the factor
    before = [headers[k] for k in headers if k < i and headers[k]['type'] == 164]
    if header['ordinate_spec_data_type'] == _ACCELERATION and before and before[-1]['length'] > 0.0:
        factor = 1.0 / float(before[-1]['length'])
        return 'm/s^2' if factor == 1.0 else f'{factor!r} m/s^2'
    return ''


def _named(found: list[Channel]) -> list[Channel]:
    """Give each channel a name of its own: place and direction, else the line of text, else the number."""
    places = Counter(c.name for c in found)
    texts = Counter(c.short for c in found)
    named = []
    for i, channel in enumerate(found):
        name, short = channel.name, channel.short
        if places[name] > 1 or name.startswith('0'):
            name = short if short and texts[short] == 1 else f'{name}#{i + 1}'
        named.append(Channel(**{**vars(channel), 'name': name, 'short': short}))
    return named
