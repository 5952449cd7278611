# SPDX-FileCopyrightText: 2026 The satvib authors
# SPDX-License-Identifier: Apache-2.0
"""Units for signals that are far from 1, so that a model does not depend on the units of its signals.

P(0), floors and bounds are numbers in m/s^2 and V. Signals below a millionth or above 10^9 of these (charge in C,
displacement in m, counts of a converter) would meet them: P(0) alone would hold the estimate at 0. The first samples
tell, once the input has moved: their largest magnitude gives a power of two, in which the signal is counted from
then on. Powers of two change no bit. Signals of the usual size keep the unit 1, so nothing at all is changed for them.
"""

import numpy as np
from satvib_common.arrays import Array, Mask

WATCHED = 32  # samples from the first input that is not 0
SMALLEST, LARGEST = 2.0**-20, 2.0**30


class SignalUnits:
    """Units of output and input, item by item.

    Args:
        shape: leading axes.

    Attributes:
        output, input: (shape) powers of two, m/s^2 and V; 1 until more is known.
        are_one: all of them are 1.
        settled: nothing more is looked at.
    """

    def __init__(self, shape: tuple[int, ...]) -> None:
        self.shape = shape
        self.reset()

    def reset(self) -> None:
        """Know nothing."""
        self.output, self.input = np.ones(self.shape), np.ones(self.shape)
        self._largest = np.zeros((2, *self.shape))
        self._count = np.zeros(self.shape)
        self.are_one, self.settled = True, False

    def watch(self, output: Array, voltage: Array) -> Mask:
        """Look at a sample, (shape) each, NaN where not known; gives the items whose units change with it."""
        watching = self._count < WATCHED
        moved = watching & ((self._count > 0.0) | (np.abs(np.nan_to_num(voltage)) > 0.0))
        signals = np.abs(np.nan_to_num(np.stack([output, voltage]), posinf=0.0, neginf=0.0))
        self._largest = np.where(moved, np.maximum(self._largest, signals), self._largest)
        self._count = self._count + moved
        ready = moved & (self._count == WATCHED)
        # an output that has not moved yet: its first sample that does is waited for
        waiting = ready & (self._largest[0] == 0.0)
        self._count = self._count - waiting
        ready &= ~waiting
        far = ready & np.any((self._largest < SMALLEST) | (self._largest > LARGEST), axis=0)
        if far.any():
            units = np.ldexp(1.0, np.frexp(self._largest)[1])
            self.output = np.where(far, units[0], self.output)
            self.input = np.where(far, units[1], self.input)
            self.are_one = False
        self.settled = bool((self._count >= WATCHED).all())
        return np.asarray(far)

    def of_parameters(self, poles: int, count: int) -> Array:
        """What a, b are multiplied by to be in m/s^2 and V, (*shape, count)."""
        found = np.ones((*self.shape, count))
        found[..., poles:] = (self.output / self.input)[..., None]
        return found
