# SPDX-FileCopyrightText: 2026 The satvib authors
# SPDX-License-Identifier: Apache-2.0
"""How long after its sample every voltage arrived: the figure by which a real-time graph is judged."""

import time
from array import array
from pathlib import Path

import numpy as np
from satvib_common.errors import RunError


class Arrivals:
    """Notes arrivals, if a file is given.

    Args:
        path: of the .npz file: `voltages` (n, 3) strut, sample, s after the sample was published, and
            `late_samples`; empty: nothing is noted.
    """

    def __init__(self, path: str) -> None:
        self._path = path
        self._noted = array('d')
        self._published: dict[int, float] = {}

    def published(self, k: int) -> None:
        """Note the instant of a sample, before the first of its messages goes out."""
        if self._path:
            self._published[k] = time.perf_counter()
            self._published.pop(k - 1000, None)

    def arrived(self, strut_index: int, k: int) -> None:
        """Note that a voltage for sample k has arrived."""
        if self._path and (begin := self._published.get(k)) is not None:
            self._noted.extend((strut_index, k, time.perf_counter() - begin))

    def save(self, late_samples: int) -> None:
        """Write the file.

        Args:
            late_samples: how many samples went out a period too late.

        Raises:
            RunError: it cannot be written.
        """
        if not self._path:
            return
        try:
            with Path(self._path).open('wb') as sink:
                voltages = np.array(self._noted).reshape(-1, 3)
                np.savez(sink, voltages=voltages, late_samples=late_samples)
        except OSError as error:
            raise RunError(f'{self._path}: cannot be written: {error.strerror}') from None
