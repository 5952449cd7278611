# SPDX-FileCopyrightText: 2026 The satvib authors
# SPDX-License-Identifier: Apache-2.0
"""Filtered-x recursive least squares with a factored covariance and a leak.

In the modified form (see `fxlms`) the weights enter linearly, so they can be found by least squares: the minimum of

    sum over i of lambda^(k-i) (d_hat(i) + w^T phi_f(i))^2  +  rho |w|^2.

P, the inverse of the information matrix, is kept as U D U^T (Bierman 1977, section V.3): symmetric and positive
definite whatever rounding does. A tone excites two directions of many, and plain forgetting would let P grow without
bound in the others until noise is believed. So every sample brings, after the measurement, one more line that says
"weight j is 0", j going round (dynamic regularization: Gay 1996, ICASSP, 957). In the mean that adds

    rho = q <|phi_f|^2> / (p (1 - lambda))

to the information of each of the p weights: the leak q is a share of the mean power per weight, as in `fxlms`, P cannot
pass 1 / rho, and unneeded weights fade.

`pace` scales the correction of the weights alone; 1 is least squares, less is the back-off of `error_watch`. With an
error in G_hat the weights settle with the time constant of the memory divided by Re(G / G_hat): the 90 degrees of fxlms
hold here too.
"""

import numpy as np
from numba import njit
from satvib_common.kernels.compile import kernel
from satvib_common.kernels.dot import dot_of
from satvib_common.kernels.ud import LARGEST, bounded, change_column, column_product

TINY = 1e-30


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
    'void(f8[:], f8, f8, b1, f8[:], f8[:], f8[:,:], f8[:], f8[:], f8[:])',
    '(p),(),(),(),(n),(p),(p,p),(p),(o)->()',
    writable=('weights', 'U', 'd', 'memory'),
)
def fxrls(regressor, error, power, active, settings, weights, U, d, memory, norm):
    """One step of the weights and of P = U D U^T, in place.

    Args:
        regressor: (p) phi_f.
        error: () e of the present weights, m/s^2.
        power: () |phi_f|^2 that the leak is a share of.
        active: () bool; nothing changes where it is false.
        settings: (4) pace (0 to 1), leak q, 1 - lambda, not used.
        weights: (p) V/(m/s^2), changed.
        U: (p, p) unit upper triangular, changed.
        d: (p) diagonal, changed; set anew when the mean power is 0.
        memory: (2) mean of the power and the next j, changed.
        norm: () out, 2-norm of the weights squared.
    """
    p = regressor.shape[0]
    pace, leak, share = settings[0], settings[1], settings[2]
    total = dot_of(regressor, regressor)
    if active and power > TINY and total < 1e140 and abs(error) < 1e140:
        gain = np.zeros(p)
        if memory[0] == 0.0:
            memory[0] = power
            for i in range(p):
                d[i] = p * share / (leak * power)
                for j in range(p):
                    U[i, j] = 1.0 if i == j else 0.0
        else:
            memory[0] += share * (power - memory[0])
        for i in range(p):
            d[i] = min(d[i] / (1.0 - share), LARGEST)
        _measure(regressor, 0, -error, pace, weights, U, d, gain)
        j = int(memory[1])
        root = np.sqrt(leak * memory[0])
        row = np.zeros(p)
        row[j] = root
        _measure(row, j, -root * weights[j], pace, weights, U, d, gain)
        memory[1] = 0.0 if j + 1 >= p else j + 1.0
    norm[0] = dot_of(weights, weights)
