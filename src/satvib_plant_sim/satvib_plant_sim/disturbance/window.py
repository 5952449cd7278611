# SPDX-FileCopyrightText: 2026 The satvib authors
# SPDX-License-Identifier: Apache-2.0
"""When a disturbance acts, for compiled code."""

from enum import IntEnum

from satvib_common.kernels.deferred import njit


class Window(IntEnum):
    """The times of one disturbance."""

    START = 0  # fine index
    STOP = 1  # fine index, the first at which it no longer acts
    PERIOD = 2  # s, of the fine time


@njit
def acts(window, n):
    """Whether a disturbance acts at fine index n."""
    return window[Window.START] <= n < window[Window.STOP]


@njit
def elapsed(window, n):
    """Give the time since the start at fine index n, s."""
    return (n - window[Window.START]) * window[Window.PERIOD]
