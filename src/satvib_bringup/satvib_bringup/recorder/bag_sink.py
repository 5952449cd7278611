# SPDX-FileCopyrightText: 2026 The satvib authors
# SPDX-License-Identifier: Apache-2.0
"""Writes a rosbag2 bag (MCAP) from a thread of its own, so that no node waits for the disk.

Five times a second what has been written is closed into a chunk and handed to the operating system: a recorder that is
killed loses a fifth of a second, and `salvage` makes a bag of the rest. The index of a chunk stays in memory until the
end. So chunks of long recordings are longer, 2 s after ten minutes; the index of an hour is a megabyte. Before the disk
is full the recording ends, while there is room for index and metadata.
"""

import threading
from array import array
from collections import deque
from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from io import BytesIO
from pathlib import Path
from typing import Any

from rosbags.interfaces import Connection, Qos
from rosbags.rosbag2 import StoragePlugin, Writer
from rosbags.rosbag2.errors import WriterError
from satvib_common.errors import RunError, SatvibError
from satvib_common.files.disk import MEGABYTE, room_at

_BATCH = 0.05  # s
# batches of a chunk, at first and at most; between them a three-hundredth of the recording
_SHORTEST, _LONGEST, _SHARE = 4, 40, 300
# bytes for what is under way and for metadata.yaml, and for the index of a chunk
_ROOM, _ROOM_OF_CHUNK = 4 * MEGABYTE, 1000
# bytes without which no recording begins
_ROOM_TO_BEGIN = 4 * _ROOM


@dataclass
class Channel:
    """A topic of the bag: its name, the type of its messages with definition and hash, and what its writer offers."""

    topic: str
    kind: str
    text: str
    type_hash: str
    qos: Qos
    connection: Connection | None = None


class ChunkIndex:
    """The index entries of the chunks, as the writer's list of them is used, in one buffer.

    An entry has some 250 bytes. As an object of its own it would take three times as much, 1.3 MB in an hour.
    """

    def __init__(self) -> None:
        self._data = bytearray()
        self._ends = array('Q')

    def append(self, entry: BytesIO) -> None:
        """Take the entry of the next chunk."""
        self._data += entry.getbuffer()
        self._ends.append(len(self._data))

    def __len__(self) -> int:
        """Number of chunks."""
        return len(self._ends)

    def __iter__(self) -> Iterator[BytesIO]:
        """Give the entries in order."""
        begin = 0
        for end in self._ends:
            entry = BytesIO()
            entry.write(self._data[begin:end])
            yield entry
            begin = end


class BagSink:
    """A bag that is being written.

    Args:
        folder: of the bag; it must not exist.
        custom: texts stored beside the messages.

    Raises:
        SatvibError: the folder exists, cannot be made, or has no room.
    """

    def __init__(self, folder: Path, custom: Mapping[str, str]) -> None:
        self.folder = folder
        self.written = 0
        self._failure: Exception | None = None
        self._full = ''
        self._chunks = 0
        self._queue: deque[tuple[Channel, int, bytes]] = deque()
        self._end = threading.Event()
        if (room := room_at(folder)) < _ROOM_TO_BEGIN:
            raise SatvibError(
                f'{folder}: the disk has {room / MEGABYTE:.0f} MB left, a recording needs '
                f'{_ROOM_TO_BEGIN / MEGABYTE:.0f}; make room'
            )
        self._writer = open_bag(folder, custom)
        storage: Any = self._writer.storage
        storage.chunks = ChunkIndex()
        self._thread = threading.Thread(target=self._work, name='bag', daemon=True)
        self._thread.start()

    def put(self, channel: Channel, time: int, message: bytes) -> None:
        """Hand over a serialized message; `time` in ns. Never waits."""
        self._queue.append((channel, time, message))

    def check(self) -> None:
        """Say when the disk has failed.

        Raises:
            RunError: why.
        """
        if self._failure is not None:
            raise RunError(f'{self.folder}: cannot be written: {self._failure}')
        if self._full:
            raise RunError(f'{self.folder}: {self._full}')

    def close(self) -> None:
        """Write what is left, index and metadata.

        Raises:
            RunError: the disk has failed; what was written before stays.
        """
        self._end.set()
        self._thread.join()
        if self._failure is not None:
            self.check()
        try:
            self._writer.close()
        except OSError as error:
            self._failure = error
        self.check()

    def _work(self) -> None:
        batches = last = 0
        try:
            while not self._end.wait(_BATCH) and not self._full:
                self._write_queue()
                batches += 1
                if batches - last >= min(max(batches // _SHARE, _SHORTEST), _LONGEST):
                    last = batches
                    self._flush()
                    self._look_at_the_disk()
            if not self._full:
                self._write_queue()
        except OSError as error:
            self._failure = error

    def _look_at_the_disk(self) -> None:
        room = room_at(self.folder)
        if room < _ROOM + _ROOM_OF_CHUNK * self._chunks:
            self._full = (
                f'the disk is full ({room / MEGABYTE:.1f} MB left); the recording ends here and is '
                'whole so far'
            )

    def _write_queue(self) -> None:
        queue, write = self._queue, self._writer.write
        for _ in range(len(queue)):
            channel, time, message = queue.popleft()
            write(channel.connection or self._connect(channel), time, message)
            self.written += 1

    def _connect(self, channel: Channel) -> Connection:
        channel.connection = self._writer.add_connection(
            channel.topic,
            channel.kind,
            msgdef=channel.text,
            rihs01=channel.type_hash,
            offered_qos_profiles=[channel.qos],
        )
        return channel.connection

    def _flush(self) -> None:
        """Close the chunk, so that a reader without an index finds it."""
        storage: Any = self._writer.storage
        if storage.chunk.bio.tell():
            storage.close_chunk()
            self._chunks += 1
            storage.bio.flush()


def open_bag(folder: Path, custom: Mapping[str, str]) -> Writer:
    """Open a new bag.

    Raises:
        SatvibError: the folder exists or cannot be made.
    """
    try:
        writer = Writer(folder, version=9, storage_plugin=StoragePlugin.MCAP)
        writer.open()
    except WriterError:
        raise SatvibError(f'{folder}: exists already, not overwriting') from None
    except OSError as error:
        raise SatvibError(f'{folder}: cannot be made: {error.strerror}') from None
    for key, value in custom.items():
        writer.set_custom_data(key, value)
    return writer
