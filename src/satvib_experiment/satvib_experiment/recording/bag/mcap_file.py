# SPDX-FileCopyrightText: 2026 The satvib authors
# SPDX-License-Identifier: Apache-2.0
"""The records of an MCAP file, read from its beginning and without its index, also when the file is cut or damaged.

A file that a killed recorder left has no index and no end. Its records are whole up to the last one, and of a last
chunk the messages are whole up to where it breaks off. No number in the file makes this reader allocate more than the
file itself justifies.
"""

import mmap
import struct
import zlib
from collections.abc import Iterator
from enum import Enum
from io import BytesIO
from pathlib import Path
from typing import NamedTuple

import lz4.frame
import zstandard
from mcap.data_stream import ReadDataStream
from mcap.exceptions import McapError
from mcap.opcode import Opcode
from mcap.records import Channel, Chunk, McapRecord, Message, Metadata, Schema, Statistics

MAGIC = b'\x89MCAP0\r\n'
_HEAD = struct.Struct('<BQ')
_LARGEST_KNOWN = 0x0F
_PRIVATE = 0x80
# what a reader of mcap raises for bytes that are no record
_NO_RECORD = (McapError, struct.error, UnicodeDecodeError, ValueError, OverflowError)
# compressed telemetry does not shrink more than this
_MOST_SHRINKING = 1000
_PIECE = 1 << 16
_FIXED = 40  # bytes of a chunk before its data, without the name of the compression


class Ending(Enum):
    """How a file ends."""

    WHOLE = 'whole'
    CUT = 'cut short'
    DAMAGED = 'damaged'


class _BrokenError(Exception):
    """A record that is none, or that goes beyond the end."""

    def __init__(self, at: int, opcode: int = 0, beyond: bool = False) -> None:
        super().__init__()
        self.at, self.opcode, self.beyond = at, opcode, beyond


class _Span(NamedTuple):
    opcode: int
    begin: int
    end: int


class McapFile:
    """One file; `ending` and `position` are known after its records were read.

    Args:
        path: the file.
        recover: go on behind a damaged chunk.
    """

    def __init__(self, path: Path, recover: bool = False) -> None:
        self.path, self.recover = path, recover
        self.ending = Ending.WHOLE
        self.position = 0
        self.size = path.stat().st_size
        self._messages = 0
        self._known: dict[tuple[type[McapRecord], int], McapRecord] = {}

    def records(self) -> Iterator[McapRecord]:
        """Schemas, channels, messages and metadata, in the order of the file."""
        if self.size == 0:
            self.ending = Ending.CUT
            return
        with (
            self.path.open('rb') as source,
            mmap.mmap(source.fileno(), 0, access=mmap.ACCESS_READ) as data,
        ):
            yield from self._records(data)

    def _records(self, data: mmap.mmap) -> Iterator[McapRecord]:
        start = data[: len(MAGIC)]
        if start != MAGIC:
            self._end(0, cut=MAGIC.startswith(start))
            return
        is_closed = self.size >= 2 * len(MAGIC) and data[-len(MAGIC) :] == MAGIC
        end = self.size - len(MAGIC) * is_closed
        finished = False
        try:
            for span in _spans(data, len(MAGIC), end):
                if finished:  # something behind the footer
                    raise _BrokenError(span.begin)
                finished = span.opcode == Opcode.FOOTER
                yield from self._read(data, span)
        except _BrokenError as broken:
            cut = broken.beyond and not is_closed
            if cut and broken.opcode == Opcode.CHUNK:
                yield from self._partial_chunk(data[broken.at + _HEAD.size :])
            self._end(broken.at, cut)
            return
        if not (finished and is_closed):
            self._end(self.size, cut=not is_closed)

    def _end(self, position: int, cut: bool) -> None:
        if self.ending is not Ending.DAMAGED:
            self.ending = Ending.CUT if cut else Ending.DAMAGED
            self.position = position

    def _read(self, data: mmap.mmap, span: _Span) -> Iterator[McapRecord]:
        if span.opcode != Opcode.CHUNK:
            record = _parsed(data[span.begin : span.end], span)
            if record is not None:
                self._check(record, span.begin)
                yield record
            return
        try:
            chunk = _chunk(data[span.begin : span.end], span.begin)
            content = _decompressed(chunk, span.begin)
            if len(content) != chunk.uncompressed_size or (
                chunk.uncompressed_crc and zlib.crc32(content) != chunk.uncompressed_crc
            ):
                raise _BrokenError(span.begin)
            yield from self._inside(content, span.begin)
        except _BrokenError:
            if not self.recover:
                raise _BrokenError(span.begin) from None
            self._end(span.begin, cut=False)

    def _inside(self, content: bytes, at: int) -> Iterator[McapRecord]:
        for span in _spans(content, 0, len(content)):
            record = _parsed(content[span.begin : span.end], span)
            if record is not None:
                self._check(record, at)
                yield record

    def _partial_chunk(self, data: bytes) -> Iterator[McapRecord]:
        """The messages that are whole in a chunk without its end."""
        if len(data) < _FIXED:
            return
        try:
            chunk = _chunk(data, 0, whole=False)
            yield from self._inside(_decompressed(chunk, 0), 0)
        except _BrokenError:
            return

    def _check(self, record: McapRecord, at: int) -> None:
        """Refuse what contradicts what was read before: the summary repeats schemas and channels, and counts."""
        if isinstance(record, Message):
            self._messages += 1
        elif isinstance(record, Schema | Channel):
            before = self._known.setdefault((type(record), record.id), record)
            if before != record and not self.recover:
                raise _BrokenError(at)
        elif isinstance(record, Statistics) and record.message_count != self._messages:
            raise _BrokenError(at)


def _spans(data: bytes | mmap.mmap, at: int, end: int) -> Iterator[_Span]:
    """Where the records from `at` to `end` stand."""
    while at < end:
        if at + _HEAD.size > end:
            raise _BrokenError(at, beyond=True)
        opcode, length = _HEAD.unpack_from(data, at)
        if not 0 < opcode <= _LARGEST_KNOWN and opcode < _PRIVATE:
            raise _BrokenError(at, opcode)
        begin = at + _HEAD.size
        if length > end - begin:
            raise _BrokenError(at, opcode, beyond=True)
        at = begin + length
        yield _Span(opcode, begin, at)


def _parsed(content: bytes, span: _Span) -> McapRecord | None:
    """The record of some bytes; None for those that nothing is needed of."""
    stream = ReadDataStream(BytesIO(content))
    try:
        if span.opcode == Opcode.MESSAGE:
            return Message.read(stream, len(content))
        if span.opcode == Opcode.SCHEMA:
            record: McapRecord = Schema.read(stream)
        elif span.opcode == Opcode.CHANNEL:
            record = Channel.read(stream)
        elif span.opcode == Opcode.METADATA:
            record = Metadata.read(stream)
        elif span.opcode == Opcode.STATISTICS:
            record = Statistics.read(stream)
        else:
            return None
    except _NO_RECORD:
        raise _BrokenError(span.begin) from None
    if stream.count != len(content):
        raise _BrokenError(span.begin)
    return record


def _chunk(content: bytes, at: int, whole: bool = True) -> Chunk:
    try:
        chunk = Chunk.read(ReadDataStream(BytesIO(content)))
    except _NO_RECORD:
        raise _BrokenError(at) from None
    if whole and len(content) != _FIXED + len(chunk.compression.encode()) + len(chunk.data):
        raise _BrokenError(at)
    return chunk


def _decompressed(chunk: Chunk, at: int) -> bytes:
    """The content of a chunk, or as much of it as there is; never more than the chunk says."""
    size = chunk.uncompressed_size
    if chunk.compression == '':
        return chunk.data
    if size > _MOST_SHRINKING * (len(chunk.data) + 1000):
        raise _BrokenError(at)
    if chunk.compression == 'zstd':
        return unpacked_zstd(chunk.data, size)
    if chunk.compression == 'lz4':
        try:
            return bytes(lz4.frame.LZ4FrameDecompressor().decompress(chunk.data, size))
        except (RuntimeError, ValueError, EOFError):
            raise _BrokenError(at) from None
    raise _BrokenError(at)


def unpacked_zstd(data: bytes, most: int) -> bytes:
    """Decompress up to `most` bytes, or as much as there is before the data break off."""
    found = BytesIO()
    with zstandard.ZstdDecompressor().stream_reader(
        BytesIO(data), read_across_frames=True
    ) as source:
        try:
            while found.tell() < most:
                piece = source.read(min(_PIECE, most - found.tell()))
                if not piece:
                    break
                found.write(piece)
        except zstandard.ZstdError:
            pass
    return found.getvalue()
