# SPDX-FileCopyrightText: 2026 The satvib authors
# SPDX-License-Identifier: Apache-2.0
"""Columns of a file of any format: which reader it needs, and what it holds."""

import importlib
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from pathlib import Path

from satvib_common.errors import SatvibError, printable
from satvib_common.records.encoding import READABLE, TEXT_SUFFIXES, foreign_format
from satvib_common.records.formats.channels import Channels
from satvib_common.records.formats.kinds import Format, format_of
from satvib_common.records.layout import Reading
from satvib_common.records.table import Table, listed
from satvib_common.records.text_table import list_text, read_text

_LABVIEW = 'LabVIEW Measurement'
_LONGEST = 4000  # characters of a line about a file; a list of columns may be long


def has_columns(path: Path, columns_given: bool) -> bool:
    """Whether a file is one of columns: a text, or one of the formats of `formats/`; and not a bag or a run.

    Args:
        path: the file.
        columns_given: whether columns were named, which makes a text of a file of any ending.

    Raises:
        SatvibError: a file of a known other format, which is named with those that are readable.
    """
    if path.is_dir() or path.suffix.lower() in {'.mcap', '.npz', '.db3'}:
        return False
    if path.suffix.lower() in TEXT_SUFFIXES or columns_given or format_of(path):
        return True
    try:
        with path.open('rb') as source:
            name = foreign_format(source.read(32))
    except OSError:
        name = ''
    if name or (path.is_file() and path.name != 'metadata.yaml'):
        raise SatvibError(
            f'{path}: is {name or "not a format that is known by its ending"}; {READABLE}'
        )
    return False


def read_table(
    path: Path, wanted: Sequence[str], time: str | None = None, reading: Reading | None = None
) -> Table:
    """Read columns of a file of any format.

    Args:
        path: the file.
        wanted: names of columns or channels, or their numbers from 1.
        time: name or number of the time column; None: as the file has it.
        reading: what is given about the file; the rest is found out.

    Raises:
        SatvibError: no such file or column, a file that is damaged, a library that is missing.
    """
    kind = format_of(path)
    if kind is None and _is_labview(path, reading):
        from satvib_common.records.formats.labview import read_labview

        return read_labview(path, wanted, time, reading)
    if kind is None:
        return read_text(path, wanted, time, reading)
    with _opened(path, kind, reading) as channels:
        return channels.table(path, wanted, time)


def list_columns(path: Path, reading: Reading | None = None) -> str:
    """List the columns of a file with their numbers; '' for a text without a header line.

    Raises:
        SatvibError: see `read_table`.
    """
    kind = format_of(path)
    if kind is None and _is_labview(path, reading):
        from satvib_common.records.formats.labview import list_labview

        return listed(list_labview(path, reading))
    if kind is None:
        return listed(list_text(path, reading))
    with _opened(path, kind, reading) as channels:
        if not channels.found:
            raise SatvibError(f'{path}: is {kind.what} without any column of numbers')
        return channels.listed()


@contextmanager
def _opened(path: Path, kind: Format, reading: Reading | None) -> Iterator[Channels]:
    """The channels of a file; what is wrong with it is one line, also where a damaged name holds anything."""
    module = importlib.import_module(f'satvib_common.records.formats.{kind.module}')
    try:
        with module.channels(path, reading is not None and reading.recover) as channels:
            yield channels
    except SatvibError as error:
        most = _LONGEST + len(str(path))
        escaped = printable(str(error), most)
        raise SatvibError(printable(escaped, most)) from None


def _is_labview(path: Path, reading: Reading | None) -> bool:
    """Whether a text begins as LabVIEW writes it."""
    skip = reading.skip if reading else 0
    try:
        with path.open('rb') as source:
            start = source.read(512)
    except OSError:
        return False
    text = start.replace(b'\x00', b'').decode('latin-1').lstrip('ÿþï»¿\r\n')
    return not skip and text.startswith(_LABVIEW)
