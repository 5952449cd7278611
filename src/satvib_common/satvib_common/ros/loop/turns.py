# SPDX-FileCopyrightText: 2026 The satvib authors
# SPDX-License-Identifier: Apache-2.0
"""Turns of the main loop: an executor works on what comes, until a time or until somebody wakes the loop.

`spin_until_future_complete` of rclpy's EventsExecutor does that, too. But it wraps a function for Python in each call,
and pybind11 3.0 loses 32 bytes with each wrapped function. A plant at 200 Hz lost 40 MB in an hour that way. So the
function is wrapped once here, and `spin_once` is called, which wraps none.
"""

import threading
import time
from collections.abc import Callable
from typing import Any

from rclpy.executors import Executor, SingleThreadedExecutor
from rclpy.task import Future

_OVERTIME = 0.02  # s beyond its time that a turn works on what is there; a flood would let none end


class Turns:
    """Lets an executor work.

    Args:
        executor: that has not worked yet.
        handled: counts the messages that have been worked on.
    """

    def __init__(self, executor: Executor, handled: Callable[[], int]) -> None:
        self._executor, self._handled = executor, handled
        self._woken = False
        self._there = threading.Lock()  # the executor is
        self._future: Future | None = None  # of a turn of an executor of Python
        self._stop: Callable[[None], object] | None = None
        if not isinstance(executor, SingleThreadedExecutor):
            asked: Any = _Asked()
            executor.spin_until_future_complete(asked, timeout_sec=0.0)
            self._stop = asked.stop

    def take(self, wait: float) -> None:
        """Work on what comes within a time, and on what is there then; no longer when somebody has woken the loop.

        Args:
            wait: s.
        """
        if self._stop is None:
            self._future = Future()
            wait = 0.0 if self._woken else wait
            self._woken = False
            self._executor.spin_until_future_complete(self._future, timeout_sec=wait)
            return
        if self._woken:
            self._woken, wait = False, 0.0
            self._executor.spin_once(timeout_sec=0.0)  # the stop may still be pending
        deadline = time.monotonic() + wait
        left = wait
        while True:
            before = self._handled()
            self._executor.spin_once(timeout_sec=left)
            if self._woken:
                self._woken = False
                return
            now = time.monotonic()
            left = max(deadline - now, 0.0)
            if left == 0.0 and (self._handled() == before or now > deadline + _OVERTIME):
                return

    def wake(self) -> None:
        """End the turn that is under way, or let the next one not wait; from any thread."""
        self._woken = True
        with self._there:
            stop, future = self._stop, self._future
            if stop is not None:
                stop(None)
            elif future is not None and not future.done():
                future.set_result(None)

    def close(self) -> None:
        """Nobody can be woken any more: the executor goes."""
        with self._there:
            self._stop, self._future = None, None


class _Asked:
    """In the place of a future: keeps the function with which the executor wants to be told that it is done."""

    stop: Callable[[None], object]

    def add_done_callback(self, stop: Callable[[None], object]) -> None:
        """Keep it."""
        self.stop = stop

    def remove_done_callback(self, _stop: Callable[[None], object]) -> None:
        """It stays."""

    def done(self) -> bool:
        """It never is."""
        return False
