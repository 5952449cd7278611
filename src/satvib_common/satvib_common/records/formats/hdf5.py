# SPDX-FileCopyrightText: 2026 The satvib authors
# SPDX-License-Identifier: Apache-2.0
"""HDF5 files, by h5py: those of MATLAB 7.3 (.mat) and plain ones (.h5).

Names are as in older MATLAB files, with points between structure and field. A plain file has a slash there, as HDF5
writes a path. Links to other files are not followed.
"""

import math
from collections.abc import Iterator
from contextlib import ExitStack, contextmanager
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

from satvib_common.records.formats.arrays import DEEPEST, OBJECT, array_channels
from satvib_common.records.formats.channels import Channel, Channels, scalars_of
from satvib_common.records.formats.kinds import HDF5, check_size, needs, one_line

_INNER = frozenset({'#refs#', '#subsystem#'})  # MATLAB's own groups
_UNITS = ('unit', 'units', 'Unit', 'Units')


@contextmanager
def channels(path: Path, recover: bool = False) -> Iterator[Channels]:
    """List the channels of a file; they can be loaded inside the `with`.

    Raises:
        SatvibError: h5py is missing, or the file is damaged.
    """
    del recover  # HDF5 itself refuses a file that is cut
    with needs(path, HDF5.what, 'h5py'):
        import h5py
    with ExitStack() as stack:
        with one_line(path, HDF5.what):
            file = stack.enter_context(h5py.File(path, 'r'))
            matlab = any('MATLAB_class' in item.attrs for item in _items(h5py, file).values())
            walk = _Walk(h5py, path, '.' if matlab else '/')
            walk.group(file, '', 0)
        walk.found.scalars = scalars_of(walk.pairs)
        yield walk.found


def _items(h5py: Any, group: Any) -> dict[str, Any]:
    """What is in a group itself, without links that lead elsewhere."""
    return {
        name: group[name]
        for name in group
        if name not in _INNER and isinstance(group.get(name, getlink=True), h5py.HardLink)
    }


@dataclass
class _Walk:
    """A walk through a file.

    Attributes:
        h5py: the library.
        path: of the file.
        sign: between a group and what is in it.
        found: the channels.
        pairs: single numbers by name.
        seen: addresses of groups, since a group may hold itself.
    """

    h5py: Any
    path: Path
    sign: str
    found: Channels = field(default_factory=lambda: Channels([]))
    pairs: dict[str, Any] = field(default_factory=dict)
    seen: set[int] = field(default_factory=set)

    def group(self, group: Any, name: str, depth: int) -> None:
        """Add what is in a group."""
        address = self.h5py.h5o.get_info(group.id).addr
        if depth > DEEPEST or address in self.seen:
            return
        self.seen.add(address)
        for key, item in _items(self.h5py, group).items():
            self.item(item, f'{name}{self.sign}{key}' if name else key, name, depth)

    def item(self, item: Any, name: str, group: str, depth: int) -> None:
        """Add a group or a dataset."""
        if isinstance(item, self.h5py.Group):
            self.group(item, name, depth + 1)
        elif not isinstance(item, self.h5py.Dataset):
            return
        elif 'MATLAB_object_decode' in item.attrs:
            self.found.found.append(Channel(name=name, size=0, load=list, reason=OBJECT))
        elif self.is_text(item):
            self.found.texts.append(name)
        elif item.dtype.kind == 'O':
            self.references(item, name, group, depth)
        elif 'MATLAB_empty' not in item.attrs:
            self.dataset(item, name, group)

    def is_text(self, item: Any) -> bool:
        """Whether a dataset holds text, as MATLAB or as HDF5 writes it."""
        matlab = _text(item.attrs.get('MATLAB_class')) == 'char'
        return matlab or self.h5py.check_string_dtype(item.dtype) is not None

    def references(self, item: Any, name: str, group: str, depth: int) -> None:
        """Add the elements of cells and of structure arrays, which are references."""
        if self.h5py.check_ref_dtype(item.dtype) is None or depth > DEEPEST:
            return
        check_size(self.path, name, 8 * math.prod(item.shape))
        references = item[()].reshape(-1)
        parent, _, key = name.rpartition(self.sign)
        for i, reference in enumerate(references):
            own, inside = name, group
            if len(references) > 1:  # element i of structure array `parent` has the field `key`
                inside = f'{parent}:{i + 1}' if parent else ''
                own = f'{inside}{self.sign}{key}' if parent else f'{name}:{i + 1}'
            if reference:
                self.item(item.file[reference], own, inside, depth + 1)

    def dataset(self, item: Any, name: str, group: str) -> None:
        """Add an array of numbers."""
        size = math.prod(item.shape)
        check_size(self.path, name, item.dtype.itemsize * size)
        if size == 1 and item.dtype.kind in 'buif':
            self.pairs[name.replace(self.sign, '.')] = item[()].reshape(-1)[0]
            return

        def load() -> Any:
            with one_line(self.path, HDF5.what, f'data set {name}'):
                return item[()]

        self.found.found += array_channels(
            name,
            group.replace(self.sign, '.'),
            item.shape,
            load,
            short=name.rpartition(self.sign)[2],
            unit=next((text for key in _UNITS if (text := _text(item.attrs.get(key)))), ''),
            reason='' if item.dtype.kind in 'buif' else f'holds {item.dtype}, not numbers',
        )


def _text(value: Any) -> str:
    if isinstance(value, bytes):
        return value.decode('utf-8', 'replace')
    return value if isinstance(value, str) else ''
