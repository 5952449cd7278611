# SPDX-FileCopyrightText: 2026 The satvib authors
# SPDX-License-Identifier: Apache-2.0
"""The product a^T b, summed from the first element to the last, so that its bits do not depend on the batch."""

from satvib_common.kernels.compile import kernel
from satvib_common.kernels.deferred import njit


@njit(inline='always')
def dot_of(a, b):
    """Give a^T b of two vectors (p), inside kernels."""
    total = 0.0
    for i in range(a.shape[0]):
        total += a[i] * b[i]
    return total


@kernel('void(f8[:], f8[:], f8[:])', '(p),(p)->()')
def dot(a, b, out):
    """Give a^T b, (...), of arrays (..., p)."""
    out[0] = dot_of(a, b)
