# SPDX-FileCopyrightText: 2026 The satvib authors
# SPDX-License-Identifier: Apache-2.0
"""A thread that reports when a descriptor is readable, for a loop that cannot wait on a descriptor itself."""

import select
import threading
from collections.abc import Callable

_AGAIN = 0.001  # s; a report between two waits of the loop may be lost, so it is repeated


class ReadableThread(threading.Thread):
    """Reports that a descriptor is readable, and repeats it until the data has been read.

    Args:
        descriptor: what to watch.
        report: called from this thread.
    """

    def __init__(self, descriptor: int, report: Callable[[], None]) -> None:
        super().__init__(daemon=True, name='readable')
        self._descriptor, self._report = descriptor, report
        self._answered = threading.Event()
        self._over = False

    def run(self) -> None:
        """Watch until `stop`."""
        while not self._over:
            if select.select([self._descriptor], [], [], 0.1)[0] and not self._over:
                self._answered.clear()
                self._report()
                self._answered.wait(_AGAIN)

    def answer(self) -> None:
        """Say that it has been read."""
        self._answered.set()

    def stop(self) -> None:
        """End; the descriptor may be closed afterwards."""
        self._over = True
        self._answered.set()
        self.join()
