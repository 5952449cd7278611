# SPDX-FileCopyrightText: 2026 The satvib authors
# SPDX-License-Identifier: Apache-2.0
"""A recursive filter, sample by sample, for any batch."""

import numpy as np
from numpy.typing import ArrayLike

from satvib_common.arrays import Array, Mask
from satvib_common.kernels.compile import kernel
from satvib_common.kernels.direct_form import filter_sample


@kernel('void(f8[:], f8[:], f8[:], f8, f8[:])', '(m),(m),(k),()->()', writable=('state',))
def iir_step(b, a, state, x, y):
    """One sample per item; `state` (m - 1, at least 1) changes in place."""
    y[0] = filter_sample(b, a, state, x)


class IirFilter:
    """y = B/A x, with coefficients that may differ from item to item.

    Args:
        b: (..., m) numerator in z^-1, lowest power first.
        a: (..., n) denominator likewise; a[..., 0] is not 0.
        shape: leading axes of the signal.
    """

    def __init__(self, b: ArrayLike, a: ArrayLike, shape: tuple[int, ...] = ()) -> None:
        self.shape = shape
        self.b, self.a = self._padded(b, a)
        self.state = np.zeros((*shape, max(self.a.shape[-1] - 1, 1)))

    @staticmethod
    def _padded(b: ArrayLike, a: ArrayLike) -> tuple[Array, Array]:
        b, a = np.asarray(b, dtype=float), np.asarray(a, dtype=float)
        lead = a[..., :1]
        length = max(a.shape[-1], b.shape[-1])
        pair = []
        for c in (b, a):
            padded = np.zeros((*c.shape[:-1], length))
            padded[..., : c.shape[-1]] = c
            pair.append(padded / lead)
        return pair[0], pair[1]

    def set_coefficients(self, b: ArrayLike, a: ArrayLike) -> None:
        """Change the filter and keep its state; the order must stay."""
        self.b, self.a = self._padded(b, a)

    def step(self, x: Array) -> Array:
        """Filter one sample (shape)."""
        result: Array = np.asarray(iir_step(self.b, self.a, self.state, x))
        return result

    def reset(self, mask: Mask | bool = True) -> None:
        """Forget the past where `mask` (shape) holds."""
        self.state[...] = np.where(np.asarray(mask)[..., None], 0.0, self.state)
