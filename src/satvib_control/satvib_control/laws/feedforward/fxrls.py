# SPDX-FileCopyrightText: 2026 The satvib authors
# SPDX-License-Identifier: Apache-2.0
"""Filtered-x recursive least squares with a factored covariance and a leak.

In the modified form (see `fxlms`) the weights enter linearly, so least squares finds them: the minimum of

    sum over i of lambda^(k-i) (d_hat(i) + w^T phi_f(i))^2  +  rho |w|^2.

P, the inverse of the information matrix, is kept as U D U^T (Bierman 1977, section V.3), so it stays symmetric and
positive definite under rounding. A tone excites two directions of many. With forgetting alone P would grow without
bound in the others, until noise moves the weights. So after every measurement comes the equation "weight j is 0", with
the next j for each sample (dynamic regularization: Gay 1996, ICASSP, 957). In the mean that adds

    rho = q <|phi_f|^2> / (p (1 - lambda))

to the information of each of the p weights. The leak q is a share of the mean power per weight, as in `fxlms`; P is at
most 1 / rho, and weights that are not needed go to 0.

`pace` scales the correction of the weights and nothing else: 1 is least squares, `backoff` asks for less. With an error
in G_hat the weights settle with the time constant of the memory divided by Re(G / G_hat), so the 90 degrees of `fxlms`
hold here too.
"""

from enum import IntEnum

import numpy as np
from satvib_common.arrays import Array, Mask
from satvib_common.kernels.compile import kernel
from satvib_common.kernels.deferred import njit
from satvib_common.kernels.ordered_dot import dot_of
from satvib_common.kernels.ud import LARGEST, bounded, change_column, column_product

TINY = 1e-30


class _Slot(IntEnum):
    """What is remembered of an item beside P."""

    POWER = 0  # mean of the power that the leak is a share of; 0 before the first sample
    NEXT = 1  # j of the next equation "weight j is 0"


@njit
def _measure(w, first, error, pace, theta, U, d, gain):
    """Update (theta, U, d) by one measurement of unit variance; the elements of w before `first` are 0."""
    p = d.shape[0]
    for j in range(first):
        gain[j] = 0.0
    before = 1.0
    for j in range(first, p):
        f = column_product(j, U, w)
        v = d[j] * f
        after = before + f * v
        d[j] = bounded(d[j] * (before / after))
        change_column(j, v, -f / before, U, gain)
        before = after
    for j in range(p):
        theta[j] += pace * error * (gain[j] / before)


@kernel(
    'void(f8[:], f8, f8, b1, f8, f8, f8, f8[:], f8[:,:], f8[:], f8[:], f8[:])',
    '(p),(),(),(),(),(),(),(p),(p,p),(p),(o)->()',
    writable=('weights', 'U', 'd', 'memory'),
)
def least_squares_step(
    regressor, error, power, active, pace, leak, share, weights, U, d, memory, norm
):
    """One step of one item; see `LeastSquares`."""
    p = regressor.shape[0]
    total = dot_of(regressor, regressor)
    if active and power > TINY and total < 1e140 and abs(error) < 1e140:
        gain = np.zeros(p)
        if memory[_Slot.POWER] == 0.0:
            memory[_Slot.POWER] = power
            for i in range(p):
                d[i] = p * share / (leak * power)
                for j in range(p):
                    U[i, j] = 1.0 if i == j else 0.0
        else:
            memory[_Slot.POWER] += share * (power - memory[_Slot.POWER])
        for i in range(p):
            d[i] = min(d[i] / (1.0 - share), LARGEST)
        _measure(regressor, 0, -error, pace, weights, U, d, gain)
        j = int(memory[_Slot.NEXT])
        root = np.sqrt(leak * memory[_Slot.POWER])
        row = np.zeros(p)
        row[j] = root
        _measure(row, j, -root * weights[j], pace, weights, U, d, gain)
        memory[_Slot.NEXT] = 0.0 if j + 1 >= p else j + 1.0
    norm[0] = dot_of(weights, weights)


class LeastSquares:
    """P and the mean power of a batch of items; the weights stay with the caller.

    Args:
        size: p, number of weights.
        shape: leading axes.

    Attributes:
        U: (*shape, p, p) unit upper triangular.
        d: (*shape, p) diagonal of D.
        memory: (*shape, 2) of what is remembered beside P.
    """

    def __init__(self, size: int, shape: tuple[int, ...] = ()) -> None:
        self.U = np.zeros((*shape, size, size))
        self.d = np.zeros((*shape, size))
        self.memory = np.zeros((*shape, len(_Slot)))

    def step(
        self,
        weights: Array,
        regressor: Array,
        error: Array,
        power: Array,
        active: Mask,
        *,
        pace: Array | float,
        leak: Array | float,
        share: float,
    ) -> None:
        """One step of the weights and of P, in place.

        Args:
            weights: (*shape, p) V/(m/s^2), changed.
            regressor: (*shape, p) phi_f.
            error: shape, e of the present weights, m/s^2.
            power: shape, |phi_f|^2 that the leak is a share of.
            active: shape, bool; nothing changes where it is false.
            pace: shape, 0 to 1.
            leak: shape, q.
            share: 1 - lambda.
        """
        least_squares_step(
            regressor, error, power, active, pace, leak, share, weights, self.U, self.d,
            self.memory,
        )  # fmt: skip

    @property
    def power(self) -> Array:
        """Mean of the power (shape)."""
        return self.memory[..., _Slot.POWER]

    def reset(self, mask: Mask) -> None:
        """Begin again with the next sample where `mask` (shape) holds."""
        self.memory[...] = np.where(mask[..., None], 0.0, self.memory)
