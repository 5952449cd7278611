# SPDX-FileCopyrightText: 2026 The satvib authors
# SPDX-License-Identifier: Apache-2.0
"""Which reader a file needs, and what is said when a file is damaged or a library is missing."""

import contextlib
import re
import warnings
from collections.abc import Iterator
from pathlib import Path
from typing import NamedTuple

from satvib_common.errors import SatvibError, printable

_HDF5 = b'\x89HDF\r\n\x1a\n'
_UNIVERSAL = re.compile(rb'[\r\n]*    -1[ ]*\r*\n[ ]{0,5}([0-9]{1,5})')
# types of data sets; a column of whole numbers in a text may begin with -1, too
_DATA_SETS = frozenset(
    {15, 18, 55, 58, 82, 151, 156, 164, 1858, 2400, 2411, 2412, 2414, 2420, 2429, 2467}
)
_MOST_SHRINKING = 1032  # bytes out of one byte: the most that deflate can do
_ALWAYS = 100_000_000  # bytes that any file may unpack to


class Format(NamedTuple):
    """A format of files with channels.

    Attributes:
        what: the file is, for messages.
        module: of this room that reads it, by a function `channels(path, recover)`.
        suffixes: that such files have.
    """

    what: str
    module: str
    suffixes: tuple[str, ...]


MATLAB = Format('a MATLAB file', 'matlab', ('.mat',))
HDF5 = Format('an HDF5 or MATLAB 7.3 file', 'hdf5', ('.h5', '.hdf5', '.hdf'))
TDMS = Format('a TDMS file', 'tdms', ('.tdms',))
UNIVERSAL = Format('a universal file (UFF, UNV)', 'universal', ('.uff', '.unv', '.uf', '.bunv'))
WAVE = Format('a WAV file', 'wave', ('.wav',))
PARQUET = Format('a Parquet file', 'parquet', ('.parquet', '.pq'))
FORMATS = (MATLAB, HDF5, TDMS, UNIVERSAL, WAVE, PARQUET)


def format_of(path: Path) -> Format | None:
    """Find the format of a file by its first bytes, or else by its ending; None for any other, such as a text."""
    try:
        with path.open('rb') as source:
            start = source.read(2048)
    except OSError:
        return None
    if start.startswith(_HDF5) or start[512:].startswith(_HDF5) or start[1024:].startswith(_HDF5):
        return HDF5
    if start.startswith(b'MATLAB 5.0 MAT-file') or start[124:128] in {b'\x00\x01IM', b'\x01\x00MI'}:
        return MATLAB
    if start.startswith((b'TDSm', b'TDSh')):
        return TDMS
    if start[:4] in {b'RIFF', b'RIFX', b'RF64'} and start[8:12] == b'WAVE':
        return WAVE
    if start.startswith(b'PAR1'):
        return PARQUET
    if (found := _UNIVERSAL.match(start)) and int(found[1]) in _DATA_SETS:
        return UNIVERSAL
    return next((f for f in FORMATS if path.suffix.lower() in f.suffixes), None)


@contextlib.contextmanager
def needs(path: Path, what: str, package: str) -> Iterator[None]:
    """Say which library is missing when an import inside the `with` fails.

    Args:
        path: of the file, for the message.
        what: the file is.
        package: name of the library for pip.

    Raises:
        SatvibError: it is missing; the message has the command that installs it.
    """
    try:
        with warnings.catch_warnings():  # pyuff changes the filters of warnings when it is imported
            warnings.simplefilter('ignore')
            yield
    except ImportError:
        raise SatvibError(
            f'{path}: is {what}: {package} is missing; install it with: pip install {package}'
        ) from None


@contextlib.contextmanager
def one_line(path: Path, what: str, where: str = '') -> Iterator[None]:
    """Turn whatever a library raises on damaged bytes into one line.

    Args:
        path: of the file.
        what: it should be.
        where: in the file, as in 'channel u'.

    Raises:
        SatvibError: in the place of any other error.
    """
    try:
        with warnings.catch_warnings():
            warnings.simplefilter('ignore')
            yield
    except SatvibError:
        raise
    except FileNotFoundError:
        raise SatvibError(f'{path}: no such file') from None
    except Exception as error:  # a parser that meets damaged bytes raises anything  # noqa: BLE001
        reason = printable(' '.join(str(error).split()), 200) or type(error).__name__
        at = f' in {printable(where, 80)}' if where else ''
        raise SatvibError(f'{path}: not {what}, or damaged{at}: {reason}') from None


def check_size(path: Path, name: str, size: int) -> None:
    """Refuse what is larger than the file can hold, before anything is allocated.

    Args:
        path: of the file.
        name: of what it holds.
        size: bytes that it needs in memory.

    Raises:
        SatvibError: it is larger.
    """
    if size < 0 or size > _ALWAYS + _MOST_SHRINKING * path.stat().st_size:
        raise SatvibError(
            f'{path}: damaged: {printable(name, 80)} needs {size / 1e9:.3g} GB, which the file cannot hold'
        )
