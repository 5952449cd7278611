# SPDX-FileCopyrightText: 2026 The satvib authors
# SPDX-License-Identifier: Apache-2.0
"""Keep the old model where the new one is not trusted: the one place where laws and watches do so.

A hand-over brings a model for every strut, but only some of them are trusted. The others keep what they had, also when
the new model has another order: polynomials grow to the longest model so far, and shorter ones end with zeros.
"""

from typing import Any

import numpy as np
from satvib_common.arrays import Array, Mask
from satvib_common.signals.iir_filter import iir_step
from satvib_ident.models.iir_model import IirModel

from satvib_control.model_analysis.transfer import model_polynomials


def select(mask: Mask, new: Any, old: Any) -> Any:
    """Give `new` where the mask (shape) holds and `old` (*shape, ...) elsewhere, a new array of any kind."""
    further = (1,) * (np.ndim(old) - np.ndim(mask))
    return np.where(np.reshape(mask, np.shape(mask) + further), new, old)


def lengthen(array: Array, length: int) -> Array:
    """Fill the last axis up with zeros; an array that is long enough comes back as it is."""
    missing = length - array.shape[-1]
    if missing <= 0:
        return array
    return np.pad(array, [*[(0, 0)] * (array.ndim - 1), (0, missing)])


class TrustedModel:
    """G = B/A, item by item the last model that was trusted, and its filter.

    Args:
        shape: leading axes.

    Attributes:
        b, a: (*shape, p) polynomials in z^-1, the delay included in b; 0 and 1 until there is a model.
        state: (*shape, p - 1) of the filter, direct form II transposed.
        known: (shape) bool; there is a model.
    """

    def __init__(self, shape: tuple[int, ...] = ()) -> None:
        self.shape = shape
        self.b, self.a = np.zeros((2, *shape, 2))
        self.a[..., 0] = 1.0
        self.state = np.zeros((*shape, 1))
        self.known = np.zeros(shape, dtype=bool)

    def news(self, model: IirModel, trusted: Mask) -> Mask:
        """Where (shape) `take` would bring a model that is not there yet."""
        b, a, old_b, old_a = self._of_one_length(model)
        differs = np.any(b != old_b, axis=-1) | np.any(a != old_a, axis=-1)
        return np.asarray(trusted & (differs | ~self.known))

    def take(self, model: IirModel, trusted: Mask) -> None:
        """Take the model where it is trusted (shape); the filter keeps its state."""
        b, a, old_b, old_a = self._of_one_length(model)
        self.b, self.a = select(trusted, b, old_b), select(trusted, a, old_a)
        self.state = lengthen(self.state, self.b.shape[-1] - 1)
        self.known = self.known | trusted

    def effect(self, voltage: Array) -> Array:
        """Step by the voltage (shape, V) that is in force until the next sample.

        Returns:
            (shape) m/s^2, what it does to the next sample: the delay is at least 1, so the state holds that already.
        """
        iir_step(self.b, self.a, self.state, voltage)
        return self.state[..., 0]

    def reset(self, mask: Mask | bool = True) -> None:
        """Put the filter to rest where `mask` (shape) holds."""
        self.state[...] = select(np.broadcast_to(np.asarray(mask), self.shape), 0.0, self.state)

    def _of_one_length(self, model: IirModel) -> list[Array]:
        """B and A of the model, and those that are there."""
        b, a = model_polynomials(model)
        length = max(b.shape[-1], self.b.shape[-1])
        return [lengthen(polynomial, length) for polynomial in (b, a, self.b, self.a)]
