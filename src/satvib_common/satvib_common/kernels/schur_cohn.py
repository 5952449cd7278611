# SPDX-FileCopyrightText: 2026 The satvib authors
# SPDX-License-Identifier: Apache-2.0
"""Whether a polynomial has all its roots inside a circle, by the Schur-Cohn criterion; no roots are computed.

The Levinson recursion goes down from order n to 1. The roots of 1 + c1 z^-1 + ... + cn z^-n lie inside the unit circle
exactly where the last coefficient of each order is below 1 in magnitude. A circle of radius r needs c_i / r^i.

E. I. Jury, Theory and Application of the z-Transform Method, 1964.
"""

from satvib_common.kernels.deferred import njit


@njit(inline='always')
def inside_unit_circle(c):
    """Whether all roots in z of 1 + c1 z^-1 + ... + cn z^-n lie inside; c (n) is used up. NaN: False."""
    for order in range(c.shape[0], 0, -1):
        k = c[order - 1]
        if not abs(k) < 1.0:
            return False
        rest = 1.0 - k * k
        for i in range(order // 2):
            j = order - 2 - i
            left, right = c[i], c[j]
            c[i] = (left - k * right) / rest
            c[j] = (right - k * left) / rest
    return True


@njit(inline='always')
def inside_circle(c, radius, work):
    """Whether all roots in z of 1 + c1 z^-1 + ... + cn z^-n lie inside a circle; `work` (n) is used up."""
    factor = 1.0
    for i in range(c.shape[0]):
        factor /= radius
        work[i] = c[i] * factor
    return inside_unit_circle(work)
