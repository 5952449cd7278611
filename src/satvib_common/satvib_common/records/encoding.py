# SPDX-FileCopyrightText: 2026 The satvib authors
# SPDX-License-Identifier: Apache-2.0
"""From the bytes of a text file to its text: byte-order marks, UTF-8, UTF-16, and what Windows loggers write."""

import codecs
import re
from pathlib import Path

from satvib_common.errors import SatvibError

READABLE = (
    'readable are text files (.csv .tsv .txt .dat, any separator), LabVIEW (.lvm .tdms), MATLAB (.mat), HDF5 (.h5), '
    'universal files (.uff .unv), WAV and Parquet, with --input and --output; a bag (.mcap or its folder), and '
    'recording.npz'
)
TEXT_SUFFIXES = frozenset({'.csv', '.tsv', '.txt', '.dat', '.lvm', '.asc', '.prn', '.tab', '.log'})
_MARKS = (
    (codecs.BOM_UTF8, 'utf-8-sig'),
    (codecs.BOM_UTF32_LE, 'utf-32'),
    (codecs.BOM_UTF32_BE, 'utf-32'),
    (codecs.BOM_UTF16_LE, 'utf-16'),
    (codecs.BOM_UTF16_BE, 'utf-16'),
)
_FOREIGN = (
    (b'PK\x03\x04', 'an Excel workbook or a zip archive'),
    (b'\xd0\xcf\x11\xe0', 'an old Excel workbook'),
    (b'Obj\x01', 'an Avro file'),
    (b'ARROW1', 'an Arrow or Feather file'),
    (b'\x1f\x8b', 'compressed with gzip'),
    (b'\x93NUMPY', 'a NumPy array'),
    (b'SQLite format 3', 'an SQLite database'),
    (b'\x89MCAP', 'a bag, which has no columns'),
    (b'%PDF', 'a PDF document'),
    (b'%!PS', 'a PostScript document'),
    (b'{\\rtf', 'an RTF document'),
    (b'\x89PNG', 'a PNG picture'),
    (b'\xff\xd8\xff', 'a JPEG picture'),
    (b'GIF8', 'a GIF picture'),
    (b'<!DOCTYPE', 'a page of HTML'),
    (b'<html', 'a page of HTML'),
    (b'<?xml', 'an XML document'),
    (b'BZh', 'compressed with bzip2'),
    (b'\xfd7zXZ', 'compressed with xz'),
    (b'\x28\xb5\x2f\xfd', 'compressed with zstd'),
    (b"7z\xbc\xaf'", 'a 7z archive'),
    (b'Rar!', 'a RAR archive'),
    (b'\x7fELF', 'a program'),
)
_CONTROL = re.compile('[\x00-\x08\x0e-\x1f\x7f]')
_SAMPLE = 4096  # bytes in which UTF-16 without a mark shows


def foreign_format(start: bytes) -> str:
    """Name the format of a file that is no text, from its first bytes; '' for any other."""
    start = start.removeprefix(codecs.BOM_UTF8).lstrip(b' \t\r\n').lower()
    return next((name for magic, name in _FOREIGN if start.startswith(magic.lower())), '')


def decode(data: bytes, path: Path, encoding: str | None = None) -> tuple[str, str]:
    """Turn the bytes of a file into text with line ends of one kind.

    Args:
        data: the whole file.
        path: of the file, for messages.
        encoding: what the file is written in; None: found out.

    Returns:
        The text, and the name of its encoding.

    Raises:
        SatvibError: an unknown encoding, bytes that are not in it, or a file that is no text.
    """
    if name := foreign_format(data[:32]):
        raise SatvibError(f'{path}: is {name}; {READABLE}')
    text, used = _told(data, path, encoding) if encoding else _found(data, path)
    text = text.removeprefix('\ufeff').rstrip('\x1a')  # DOS ends a text with it
    if control := _CONTROL.search(text):
        line = text.count('\n', 0, control.start()) + 1
        raise SatvibError(
            f'{path}: line {line}: holds the control character {control.group()!r}, so it is no text; {READABLE}'
        )
    for end in ('\r\r\n', '\r\n', '\r'):  # the first is what a text mode written twice leaves
        text = text.replace(end, '\n')
    return text, used


def _told(data: bytes, path: Path, encoding: str) -> tuple[str, str]:
    try:
        return data.decode(encoding), encoding
    except (LookupError, TypeError, ValueError, AttributeError) as error:
        if isinstance(error, UnicodeError):
            raise SatvibError(f'{path}: --encoding: is not {encoding}: {error}') from None
        raise SatvibError(
            f'--encoding: {encoding!r} is no text encoding (utf-8, utf-16, latin-1, cp1252 are)'
        ) from None


def _found(data: bytes, path: Path) -> tuple[str, str]:
    for mark, name in _MARKS:
        if data.startswith(mark):
            return _told(data, path, name)
    start = data[:_SAMPLE]
    even, odd, half = start[0::2].count(0), start[1::2].count(0), len(start) // 2
    if odd > 0.3 * half and even < 0.1 * half:
        return _told(data, path, 'utf-16-le')
    if even > 0.3 * half and odd < 0.1 * half:
        return _told(data, path, 'utf-16-be')
    for name in ('utf-8', 'cp1252'):
        try:
            return data.decode(name), name
        except UnicodeDecodeError:
            continue
    return data.decode('latin-1'), 'latin-1'
