# SPDX-FileCopyrightText: 2026 The satvib authors
# SPDX-License-Identifier: Apache-2.0
"""The regressor of a batch of struts, its filtered twins and their history.

It keeps what `regressor_kernel` needs from sample to sample, and the input of the last two seconds. When the model or
the reaction changes, that history runs through the new filters from rest, so their transients have decayed as those of
the old ones had. A new model changes only what is seen through it: u = w^T phi does not contain G_hat, so the voltage
does not jump.
"""

import math
from enum import IntEnum
from typing import TYPE_CHECKING

import numpy as np
from satvib_common.arrays import Array, Mask
from satvib_common.kernels.deferred import njit

from satvib_control.core.trusted_model import lengthen, select
from satvib_control.laws.feedforward.reaction import FREQUENCIES
from satvib_control.laws.feedforward.regressor_kernel import (
    Contents,
    RegressorState,
    motion_coefficients,
    response_table,
    run_regressor,
)

if TYPE_CHECKING:
    from satvib_ident.models.iir_model import IirModel

HISTORY = 2.0  # s
SHORT_GAP = 3  # samples that may be missing while the integrals stay valid


class _Slot(IntEnum):
    """What is remembered of the lower sensor of an item."""

    LAST = 0  # m/s^2, the newest sample that was measured
    ABSENT = 1  # samples that are missing since
    FILLING = 2  # samples until the history is complete; not above 0 when it is


@njit
def measure(lower, lost, taps, settle, sensor):
    """Count the missing samples of an item; give the reading, or the last one that there was.

    Args:
        lower: m/s^2; NaN: not measured.
        lost: samples that were lost before this one.
        taps, settle: samples that a regressor and its integrals need.
        sensor: (m) its memory, changed.
    """
    good = np.isfinite(lower)
    if good:
        sensor[_Slot.LAST] = lower
    sensor[_Slot.ABSENT] = 0.0 if good else sensor[_Slot.ABSENT] + 1.0
    gap = sensor[_Slot.ABSENT] + lost
    spoiled = taps + (settle if gap > SHORT_GAP else 0.0)
    left = sensor[_Slot.FILLING] - 1.0 if good else sensor[_Slot.FILLING]
    sensor[_Slot.FILLING] = max(left, spoiled) if gap > 0.0 else left
    return sensor[_Slot.LAST]


@njit
def is_missing(sensor):
    """Whether the newest sample of an item was not measured."""
    return sensor[_Slot.ABSENT] > 0.0


@njit
def is_filling(sensor):
    """Whether the history of an item is not complete."""
    return sensor[_Slot.FILLING] > 0.0


class FilteredReference:
    """phi and phi_f of every item; see the module.

    Args:
        contents: of the regressor.
        corner: Hz, of the motion filters.
        reaction_taps: length of the learnt reaction.
        dt: s.
        shape: leading axes.

    Attributes:
        state: phi, phi_f and what they are made from.
        known: shape, bool; there is a model.
        num, den: (*shape, m) G_hat z in z^-1.
        coefficients, sizes: (3) and (3), see `run_regressor`.
        table: (f, p, 2) responses of the regressor at `FREQUENCIES`.
        settle: samples that the integrals need.
        sensor: (*shape, 3) memory of the lower sensor.
    """

    def __init__(
        self,
        contents: Contents,
        corner: float,
        reaction_taps: int,
        dt: float,
        shape: tuple[int, ...] = (),
    ) -> None:
        self.shape, self.contents = shape, contents
        self.sizes = np.array(contents)
        self.coefficients = motion_coefficients(corner, dt)
        self.table = response_table(contents, corner, dt, FREQUENCIES)
        self._reaction_taps = max(reaction_taps, 1)
        self.num, self.den = np.zeros((2, *shape, 2))
        self.den[..., 0] = 1.0
        self.state = self._at_rest()
        self._past = np.zeros((3, max(round(HISTORY / dt), 1), *shape))  # lower, applied, own
        self._next = 0
        self.known = np.zeros(shape, dtype=bool)
        # the integrals need three time constants of their corner
        settle = math.ceil(3.0 / (2.0 * math.pi * corner * dt))
        self.settle = settle if contents.motion else 0
        self.sensor = np.zeros((*shape, len(_Slot)))
        self.sensor[..., _Slot.ABSENT] = 1.0
        self.sensor[..., _Slot.FILLING] = contents.taps + self.settle

    def _at_rest(self) -> RegressorState:
        return RegressorState.zeros(
            self.contents, self._reaction_taps, self.num.shape[-1], self.shape
        )

    def last(self, lower: Array) -> Array:
        """Give a reading (shape, m/s^2), or where it is NaN the last one that there was."""
        return np.where(np.isfinite(lower), lower, self.sensor[..., _Slot.LAST])

    def remember(self, lower: Array, applied: Array, own: Array) -> None:
        """Keep the input of a sample; see `run_regressor`."""
        self._past[:, self._next] = lower, applied, own
        self._next = (self._next + 1) % self._past.shape[1]

    def _run(
        self, state: RegressorState, lower: Array, applied: Array, own: Array, reaction: Array,
        weights: Array,
    ) -> tuple[Array, Array]:  # fmt: skip
        """Run samples (*shape, t) through the present filters."""
        found: tuple[Array, Array] = run_regressor(
            lower, applied, own, reaction, self.num, self.den, self.coefficients, self.sizes,
            weights, *state,
        )  # fmt: skip
        return found

    def set_model(
        self, model: 'IirModel', trusted: Mask, reaction: Array, weights: Array
    ) -> Mask | None:
        """Take G_hat where it is trusted; (shape) where it is another one, or None where nowhere."""
        a = np.broadcast_to(model.a, (*self.shape, model.a.shape[-1]))
        b = np.broadcast_to(model.b, (*self.shape, model.b.shape[-1]))
        # the voltages of the regressor are one sample old, so one sample of the delay has passed
        first = model.delay - 1
        length = max(1 + a.shape[-1], first + b.shape[-1], self.num.shape[-1])
        num, den = np.zeros((2, *self.shape, length))
        num[..., first : first + b.shape[-1]] = b
        den[..., 0] = 1.0
        den[..., 1 : 1 + a.shape[-1]] = a
        old_num, old_den = lengthen(self.num, length), lengthen(self.den, length)
        num, den = select(trusted, num, old_num), select(trusted, den, old_den)
        self.known = self.known | trusted
        fresh: Mask = np.any((num != old_num) | (den != old_den), axis=-1)
        if not fresh.any():
            return None
        self.num, self.den = num, den
        self.state = self.state._replace(filters=lengthen(self.state.filters, length))
        self._replay(fresh, reaction, weights, seen_through_only=True)
        return fresh

    def set_reaction(self, reaction: Array, weights: Array) -> None:
        """Protect the whole history by a reaction (*shape, r)."""
        self._replay(np.ones(self.shape, dtype=bool), reaction, weights, seen_through_only=False)

    def _replay(
        self, where: Mask, reaction: Array, weights: Array, seen_through_only: bool
    ) -> None:
        """Run the stored history through the present filters from rest."""
        lower, applied, own = np.moveaxis(np.roll(self._past, -self._next, axis=1), 1, -1)
        fresh = self._at_rest()
        self._run(fresh, lower, applied, own, reaction, weights)
        if seen_through_only:  # what u is made of stays as it is, to the last bit
            fresh.take_plain(self.state)
        for kept, new in zip(self.state, fresh, strict=True):
            kept[...] = select(where, new, kept)

    def reset(self, mask: Mask) -> None:
        """Forget the past where `mask` (shape) holds; the model stays."""
        for kept in self.state:
            kept[...] = select(mask, 0.0, kept)
        self._past[...] = np.where(mask, 0.0, self._past)
        full = float(self.contents.taps + self.settle)
        filling, last = self.sensor[..., _Slot.FILLING], self.sensor[..., _Slot.LAST]
        filling[...] = np.where(mask, full, filling)
        last[...] = np.where(mask, 0.0, last)
