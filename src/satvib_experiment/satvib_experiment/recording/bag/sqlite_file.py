# SPDX-FileCopyrightText: 2026 The satvib authors
# SPDX-License-Identifier: Apache-2.0
"""The messages of a rosbag2 database (sqlite3), also when the file is cut or damaged: every row that can be read.

A recorder that was killed may leave a write-ahead log (`-wal`) beside the file. It holds the newest messages, so both
are copied and joined before reading; the files themselves are never changed.
"""

import os
import shutil
import sqlite3
import struct
import tempfile
from collections.abc import Iterator
from contextlib import closing
from pathlib import Path
from typing import Any

from satvib_experiment.recording.bag.mcap_file import Ending

_MAGIC = b'SQLite format 3\0'
_HEAD = 100  # bytes
_SMALLEST_ROW = 8  # bytes
_ATTEMPTS = 60  # the step doubles at each


class SqliteFile:
    """One file; `ending` is known after its messages were read.

    Args:
        path: the file.
        recover: go on behind rows that cannot be read.
    """

    def __init__(self, path: Path, recover: bool = False) -> None:
        self.path, self.recover = path, recover
        self.ending = Ending.WHOLE
        self.topics: dict[int, tuple[str, str]] = {}  # name and type by id
        self.definitions: dict[str, tuple[str, str]] = {}  # encoding and text by type
        self._page, pages = _pages(path)
        self._is_short = path.stat().st_size < self._page * pages or not self._page * pages

    def messages(self, kinds: frozenset[str]) -> Iterator[tuple[str, str, int, bytes]]:
        """Topic, type, time in ns and bytes of every message of some types, in the order of the file."""
        log = self.path.with_name(f'{self.path.name}-wal')
        has_log = log.is_file() and log.stat().st_size > 0
        try:
            if not has_log and not self._is_short:
                yield from self._read(f'file:{_quoted(self.path)}?mode=ro&immutable=1', kinds)
                return
            with tempfile.TemporaryDirectory() as folder:
                copy = Path(folder) / 'bag.db3'
                shutil.copyfile(self.path, copy)
                if has_log:
                    shutil.copyfile(log, copy.with_name('bag.db3-wal'))
                elif self._page:  # SQLite would fill the rest of a page that breaks off with zeros
                    os.truncate(copy, copy.stat().st_size // self._page * self._page)
                yield from self._read(f'file:{_quoted(copy)}', kinds)
        except (sqlite3.Error, UnicodeDecodeError, TypeError, ValueError, OverflowError):
            self._broken()

    def _broken(self) -> None:
        self.ending = Ending.CUT if self._is_short else Ending.DAMAGED

    def _read(self, uri: str, kinds: frozenset[str]) -> Iterator[tuple[str, str, int, bytes]]:
        with closing(sqlite3.connect(uri, uri=True)) as base:
            if self._is_short:
                base.execute(
                    'PRAGMA writable_schema=ON'
                )  # reads a file with fewer pages than it says
                self._broken()
            for number, name, kind in base.execute('SELECT id, name, type FROM topics'):
                self.topics[int(number)] = (str(name), str(kind))
            self._read_definitions(base)
            wanted = {n: t for n, t in self.topics.items() if t[1] in kinds}
            for topic, time, data in self._rows(base):
                if topic in wanted and isinstance(data, bytes):
                    yield (*wanted[topic], int(time), data)

    def _read_definitions(self, base: sqlite3.Connection) -> None:
        tables = {name for (name,) in base.execute('SELECT name FROM sqlite_master')}
        if 'message_definitions' in tables:
            for kind, encoding, text in base.execute(
                'SELECT topic_type, encoding, encoded_message_definition FROM message_definitions'
            ):
                self.definitions[str(kind)] = (str(encoding), str(text))

    def _rows(self, base: sqlite3.Connection) -> Iterator[tuple[Any, Any, Any]]:
        """Rows in order; where one cannot be read, on from the next that can.

        Damaged pages may form a circle: ids must increase, and there are no more rows than the file has room for.
        """
        last, step, left = 0, 1, self.path.stat().st_size // _SMALLEST_ROW
        for _ in range(_ATTEMPTS):
            try:
                for number, topic, time, data in base.execute(
                    'SELECT id, topic_id, timestamp, data FROM messages WHERE id > ? ORDER BY id',
                    (last,),
                ):
                    left -= 1
                    if number <= last or left < 0:
                        raise sqlite3.DatabaseError
                    last, step = number, 1
                    yield topic, time, data
            except sqlite3.Error:
                self._broken()
                if not self.recover or left < 0:
                    return
                last, step = last + step, 2 * step
            else:
                return


def _pages(path: Path) -> tuple[int, int]:
    """Size of a page and number of pages, as the first page says; 0 where a file has not even that."""
    with path.open('rb') as source:
        head = source.read(_HEAD)
    if len(head) < _HEAD or not head.startswith(_MAGIC):
        return (0, 0) if _MAGIC.startswith(head[: len(_MAGIC)]) else (1, 1)
    (page,) = struct.unpack_from('>H', head, 16)
    (count,) = struct.unpack_from('>I', head, 28)
    return (65536 if page == 1 else page, count)


def _quoted(path: Path) -> str:
    return str(path.absolute()).replace('%', '%25').replace('?', '%3f').replace('#', '%23')
