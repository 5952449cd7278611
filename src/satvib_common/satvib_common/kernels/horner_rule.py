# SPDX-FileCopyrightText: 2026 The satvib authors
# SPDX-License-Identifier: Apache-2.0
"""The value of a polynomial, by Horner's rule."""

from typing import Any

from satvib_common.kernels.deferred import njit


def polynomial(c: Any, x: Any) -> Any:
    """Give c0 + c1 x + ... + cn x^n.

    Args:
        c: (n + 1) coefficients, lowest power first.
        x: a complex number, or an array of them.
    """
    total = 0.0j
    for i in range(len(c) - 1, -1, -1):
        total = total * x + c[i]
    return total


# the same inside kernels, for one x
horner = njit(inline='always')(polynomial)
