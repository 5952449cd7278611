# SPDX-FileCopyrightText: 2026 The satvib authors
# SPDX-License-Identifier: Apache-2.0
"""NumPy's .npz files, read within bounds: no array is made that the file itself does not fill.

The header of an array may state any shape, and a compressed file may unpack to a thousand times its size. Both are
compared with the file before anything is allocated, and with the memory of the machine. Python objects are refused.
"""

import math
import os
import zipfile
import zlib
from pathlib import Path
from typing import IO, Any

import numpy as np
from numpy.lib import format as npy
from numpy.typing import NDArray

from satvib_common.errors import SatvibError, printable

MOST_SHRINKING = 1032  # bytes out of one byte: the most that deflate can do
_SPARE = 10_000  # bytes of headers
# what zipfile and NumPy raise for files that are none
_NO_FILE = (ValueError, KeyError, EOFError, OSError, NotImplementedError, RuntimeError, OverflowError,
            SyntaxError, TypeError, zipfile.BadZipFile, zlib.error)  # fmt: skip


def load_npz_arrays(path: Path, what: str = 'an .npz file') -> dict[str, NDArray[Any]]:
    """Read all arrays of a file; `what` it should be is said in the error.

    Raises:
        SatvibError: it is missing, damaged, or larger than it can be.
    """
    try:
        with zipfile.ZipFile(path) as archive:
            total = sum(_check(archive, info) for info in archive.infolist())
        most = os.sysconf('SC_PHYS_PAGES') * os.sysconf('SC_PAGE_SIZE')
        if total > min(most, MOST_SHRINKING * path.stat().st_size + _SPARE):
            raise ValueError(f'its arrays need {total / 1e9:.3g} GB')
        with np.load(path, allow_pickle=False) as data:
            return {name: data[name] for name in data.files}
    except FileNotFoundError:
        raise SatvibError(f'{path}: no such file') from None
    except _NO_FILE as error:
        reason = printable(' '.join(str(error).split()), 200) or type(error).__name__
        raise SatvibError(f'{path}: not {what}, or damaged: {reason}') from None


def _check(archive: zipfile.ZipFile, info: zipfile.ZipInfo) -> int:
    """Compare the header of an array with what the archive holds; gives its size in bytes."""
    with archive.open(info) as source:
        shape, dtype = _header(source)
        size = math.prod(shape) * dtype.itemsize
        if dtype.hasobject or min(shape, default=0) < 0 or source.tell() + size != info.file_size:
            raise ValueError(f'{info.filename}: the array does not fill its file')
    return size


def _header(source: IO[bytes]) -> tuple[tuple[int, ...], np.dtype[Any]]:
    version = npy.read_magic(source)
    if version == (1, 0):
        shape, _, dtype = npy.read_array_header_1_0(source)
    elif version == (2, 0):
        shape, _, dtype = npy.read_array_header_2_0(source)
    else:
        raise ValueError(f'arrays of version {version} are not read')
    return shape, dtype
