# SPDX-FileCopyrightText: 2026 The satvib authors
# SPDX-License-Identifier: Apache-2.0
"""One sample of a recursive filter, direct form II transposed."""

from satvib_common.kernels.deferred import njit


@njit(inline='always')
def filter_sample(b, a, state, x):
    """Give y(k) of A y = B x for one item and move its state on.

    Args:
        b, a: (m) coefficients in z^-1 of equal length, lowest power first; a[0] is 1.
        state: (m - 1 or more, at least 1), changed. Its first place is what the past adds to the next output.
        x: () input x(k).
    """
    order = b.shape[0] - 1
    y = b[0] * x
    if order > 0:
        y += state[0]
        for i in range(order - 1):
            state[i] = state[i + 1] + b[i + 1] * x - a[i + 1] * y
        state[order - 1] = b[order] * x - a[order] * y
    return y
