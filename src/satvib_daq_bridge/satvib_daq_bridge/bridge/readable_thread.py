# SPDX-FileCopyrightText: 2026 The satvib authors
# SPDX-License-Identifier: Apache-2.0
"""Wakes a loop that cannot wait on a descriptor: a thread that does nothing else."""

import select
import threading
from collections.abc import Callable

_AGAIN = 0.001  # s; a ring may fall between two waits of the loop and be lost


class Bell(threading.Thread):
    """Rings when a descriptor is readable, and again until somebody has read it.

    Args:
        descriptor: what to watch.
        ring: called from this thread.
    """

    def __init__(self, descriptor: int, ring: Callable[[], None]) -> None:
        super().__init__(daemon=True, name='bell')
        self._descriptor, self._ring = descriptor, ring
        self._answered = threading.Event()
        self._over = False

    def run(self) -> None:
        """Watch until `stop`."""
        while not self._over:
            if select.select([self._descriptor], [], [], 0.1)[0] and not self._over:
                self._answered.clear()
                self._ring()
                self._answered.wait(_AGAIN)

    def answer(self) -> None:
        """Say that it has been read."""
        self._answered.set()

    def stop(self) -> None:
        """End; the descriptor may be closed afterwards."""
        self._over = True
        self._answered.set()
        self.join()
