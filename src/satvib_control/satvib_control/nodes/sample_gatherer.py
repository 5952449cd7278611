# SPDX-FileCopyrightText: 2026 The satvib authors
# SPDX-License-Identifier: Apache-2.0
"""Gathers the items of one sample from several streams, which arrive in any order."""

from typing import Generic, TypeVar

T = TypeVar('T')

# incomplete samples that are kept; strays far ahead never become complete
_KEPT = 256


class SampleGatherer(Generic[T]):
    """One item per stream and sample.

    When a sample is complete the older ones are dropped, because a controller answers the newest. Sample 0 after a
    complete sample is the first of a new run.

    Args:
        streams: how many.
    """

    def __init__(self, streams: int) -> None:
        self._streams = streams
        self._parts: dict[int, dict[int, T]] = {}
        self._done = -1

    def add(self, stream: int, sequence: int, item: T) -> list[T] | None:
        """Take an item; give the items of all streams when this one was the last of its sample."""
        if sequence <= self._done:
            if sequence == 0:
                self._done = -1
                self._parts.clear()
            else:
                return None
        parts = self._parts.setdefault(sequence, {})
        parts[stream] = item
        if len(parts) < self._streams:
            if len(self._parts) > _KEPT:
                ahead = max(self._parts)
                del self._parts[ahead if ahead > sequence else min(self._parts)]
            return None
        self._done = sequence
        self._parts = {k: v for k, v in self._parts.items() if k > sequence}
        return [parts[i] for i in range(self._streams)]
