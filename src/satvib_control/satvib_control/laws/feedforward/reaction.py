# SPDX-FileCopyrightText: 2026 The satvib authors
# SPDX-License-Identifier: Apache-2.0
"""The strut's own reaction in the reference, and how it is subtracted.

A coil that pushes the payload up pushes the lower plate down, and no shaker is rigid. The lower sensor measures

    x_m = x_0 + F u,

so a feedforward filter W on x_m closes the loop 1 - W F, and nothing makes that stable. In IDENTIFY the voltage is
known and does not depend on the disturbance. There F can be learnt, as a short FIR filter, by least squares:

    F_hat = arg min sum (x_m(k) - sum_i F_i u(k-1-i))^2,    i = 0 .. r - 1.

W then works on x = x_m - F_hat u, and the loop is 1 - W (F - F_hat).

F_hat is used only if it explains more than chance: with N samples, r taps, a total T and a remainder E of the sum of
squares, (T - E) / r > 10 E / N (an F test, with a margin for coloured remainders). Otherwise the reaction is too small
to measure, and F_hat is 0.

A strut knows its own voltage only. On a shared lower plate the reactions of the other struts stay in the reference. Of
n struts that act alike the loop is then 1 - (n - 1) W F in phase, and 1 + W F in opposite phase. By the small-gain
theorem both are stable while |W F| < 1 / (n - 1) at all frequencies. `loop_gain` computes that, and the law raises its
leak where the bound would be exceeded.
"""

import numpy as np
from satvib_common.arrays import Array, Mask
from satvib_common.kernels.compile import kernel
from satvib_common.kernels.ordered_dot import dot

from satvib_control.laws.feedforward.fxrls import LeastSquares

LEAK = 1e-6  # the least that keeps a badly excited filter small
SHARE = 1e-5  # of the present sample: a memory of 1e5 samples
SIGNIFICANT = 10.0  # see the module
# where the loop gain is evaluated, as shares of the sample rate
FREQUENCIES = np.arange(1, 65) / 128.0


@kernel('void(f8[:], f8[:,:,:], i8, f8[:], f8[:])', '(p),(f,p,c),(),(f)->()')
def loop_gain(weights, table, poles, reaction, gain):
    """Largest |W F_hat| over the frequencies of a table.

    Args:
        weights: (p) V/(m/s^2).
        table: (f, p, 2) real and imaginary part of each element of the regressor per m/s^2 of reference (the last
            `poles`: per volt).
        poles: () how many of the weights act on past voltages.
        reaction: (f) |F_hat|, m/s^2/V.
        gain: () out.
    """
    gain[0] = 0.0
    first = weights.shape[0] - poles
    for k in range(reaction.shape[0]):
        re, im = 0.0, 0.0
        for i in range(first):
            re += weights[i] * table[k, i, 0]
            im += weights[i] * table[k, i, 1]
        power = re * re + im * im
        re, im = 1.0, 0.0
        for i in range(first, weights.shape[0]):
            re -= weights[i] * table[k, i, 0]
            im -= weights[i] * table[k, i, 1]
        if poles > 0:
            power /= max(re * re + im * im, 1e-12)
        gain[0] = max(gain[0], np.sqrt(power) * reaction[k])


class ReferenceProtection:
    """Learns the reaction of a strut's own voltage on its lower sensor.

    Args:
        taps: r; 0: no protection.
        shape: leading axes.

    Attributes:
        reaction: (*shape, r) m/s^2/V, F_hat as it is used; 0 until `finish` found something.
        magnitude: (*shape, f) |F_hat| at `FREQUENCIES`.
    """

    def __init__(self, taps: int, shape: tuple[int, ...] = ()) -> None:
        self.taps, self.shape = taps, shape
        size = max(taps, 1)
        self.reaction = np.zeros((*shape, size))
        self.magnitude = np.zeros((*shape, len(FREQUENCIES)))
        self._voltages = np.zeros((*shape, size))
        self._weights = np.zeros((*shape, size))
        self._least_squares = LeastSquares(size, shape)
        self._count = np.zeros(shape)
        self._total = np.zeros(shape)
        self._left = np.zeros(shape)

    def learn(self, lower: Array, applied: Array, valid: Mask) -> None:
        """Take a sample of IDENTIFY.

        Args:
            lower: shape, m/s^2, finite.
            applied: shape, V, the voltage of the sample before.
            valid: shape, bool; `lower` was measured.
        """
        if self.taps == 0:
            return
        self._voltages[..., 1:] = self._voltages[..., :-1].copy()
        self._voltages[..., 0] = applied
        error = dot(self._weights, self._voltages) - lower
        power = dot(self._voltages, self._voltages)
        self._least_squares.step(
            self._weights, self._voltages, error, power, valid, pace=1.0, leak=LEAK, share=SHARE
        )
        after = dot(self._weights, self._voltages) - lower
        self._count = self._count + valid
        self._total = np.where(valid, self._total + lower * lower, self._total)
        # the error before the update times the one after it: the exact growth of the minimum
        self._left = np.where(valid, self._left + error * after, self._left)

    def finish(self) -> Mask:
        """End of IDENTIFY: decide whether what was learnt is used; shape, bool."""
        explained = (self._total - self._left) / max(self.taps, 1)
        enough = self._count > 10 * self.taps
        used = enough & (explained * self._count > SIGNIFICANT * self._left)
        used = used & (self.taps > 0) & (self._total > 0.0)
        fine = used[..., None] & np.isfinite(self._weights)
        self.reaction = np.where(fine, self._weights, 0.0)
        # the one sample between a voltage and its effect does not change a magnitude
        powers = np.exp(-2j * np.pi * np.outer(FREQUENCIES, np.arange(self.reaction.shape[-1])))
        for i in np.ndindex(self.shape):
            self.magnitude[i] = np.abs(powers @ self.reaction[i])
        return used
