# SPDX-FileCopyrightText: 2026 The satvib authors
# SPDX-License-Identifier: Apache-2.0
"""How long after its sample every voltage arrived: the figure by which a real-time graph is judged."""

import contextlib
import time
import zipfile
from array import array
from pathlib import Path

import numpy as np
from numpy.lib import format as npy
from satvib_common.errors import RunError

_COLUMNS = 3
_BLOCK = 8192  # arrivals that wait in memory; an hour of three struts has two million


class Arrivals:
    """Notes arrivals, if a file is given. They go to a file beside it, block by block, until all are there.

    Args:
        path: of the .npz file: `voltages` (n, 3) strut, sample, s after the sample was published, and
            `late_samples`; empty: nothing is noted.
    """

    def __init__(self, path: str) -> None:
        self._path = path
        self._block = array('d')
        self._published: dict[int, float] = {}
        self._heap = Path(f'{path}.part')
        if path:
            with contextlib.suppress(
                OSError
            ):  # of a run before; else the first block says what is wrong
                self._heap.unlink(missing_ok=True)

    def published(self, k: int) -> None:
        """Note the instant of a sample, before the first of its messages goes out."""
        if self._path:
            self._published[k] = time.perf_counter()
            self._published.pop(k - 1000, None)

    def arrived(self, strut_index: int, k: int) -> None:
        """Note that a voltage for sample k has arrived.

        Raises:
            RunError: the block cannot be written.
        """
        if self._path and (begin := self._published.get(k)) is not None:
            self._block.extend((strut_index, k, time.perf_counter() - begin))
            if len(self._block) >= _BLOCK * _COLUMNS:
                self._write_block()

    def save(self, late_samples: int) -> None:
        """Write the file.

        Args:
            late_samples: how many samples went out a period too late.

        Raises:
            RunError: it cannot be written.
        """
        if not self._path:
            return
        self._write_block()
        try:
            with zipfile.ZipFile(self._path, 'w') as sink, self._heap.open('rb') as heap:
                count = self._heap.stat().st_size // self._block.itemsize // _COLUMNS
                head = {'descr': '<f8', 'fortran_order': False, 'shape': (count, _COLUMNS)}
                with sink.open('voltages.npy', 'w', force_zip64=True) as member:
                    npy.write_array_header_1_0(member, head)
                    while part := heap.read(2**20):
                        member.write(part)
                with sink.open('late_samples.npy', 'w') as member:
                    npy.write_array(member, np.array(late_samples))
            self._heap.unlink()
        except OSError as error:
            raise RunError(f'{self._path}: cannot be written: {error.strerror}') from None

    def _write_block(self) -> None:
        try:
            with self._heap.open('ab') as sink:
                self._block.tofile(sink)
        except OSError as error:
            raise RunError(f'{self._heap}: cannot be written: {error.strerror}') from None
        del self._block[:]
