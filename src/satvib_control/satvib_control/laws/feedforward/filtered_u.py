# SPDX-FileCopyrightText: 2026 The satvib authors
# SPDX-License-Identifier: Apache-2.0
"""Filtered-u: a feedforward filter with poles of its own.

    u(k) = sum_i w_i phi_i(k) + sum_i c_i u(k-i),    i = 1 .. P

The reference may contain the strut's own reaction, x = x_0 + F u, and then the best filter is W / (1 + W F). It is
recursive even where W is not. Filtered-u finds it (Eriksson 1991, J. Acoust. Soc. Am. 89, 257): the past voltages are
part of the regressor, and their filtered twins G_hat u part of phi_f. Eriksson moves the weights along phi_f, which is
the gradient only if C = sum c_i z^-i is small. Here the weights move along the exact gradient for slow changes,

    dy / dw_i = G phi_i / (1 - C):    phi_g = phi_f / (1 - C),

with the least squares of `fxrls`. That is the recursive prediction error method (Ljung 1999, section 11.5) instead of
pseudo-linear regression. Measured on the stiff rig with random vibration, the latter rang and had to be backed off.

None of this keeps 1 - C stable, and the error has more than one minimum. So after each step the poles are scaled into
the circle of radius r: c_i <- g^i c_i, with the largest g of 0.99^n that is enough. It scales every pole by g.
"""

import numpy as np
from satvib_common.kernels.compile import kernel
from satvib_common.kernels.schur_cohn import inside_circle


@kernel('void(f8[:], i8, f8, f8[:])', '(p),(),()->()', writable=('weights',))
def stabilize(weights, poles, radius, scale):
    """Scale the poles of the last `poles` weights into the circle of `radius`, in place.

    Args:
        weights: (p), changed.
        poles: () how many of the last weights act on past voltages.
        radius: () below 1.
        scale: () out, the factor g of the poles; 1 where nothing was done.
    """
    scale[0] = 1.0
    if poles < 1:
        return
    c = weights[weights.shape[0] - poles :]
    minus = -c
    work = np.empty(poles)
    for i in range(poles):
        if not np.isfinite(c[i]):
            c[:] = 0.0
            scale[0] = 0.0
            return
    while not inside_circle(minus, radius / scale[0], work):
        scale[0] *= 0.99
        if scale[0] < 1e-3:
            scale[0] = 0.0
            break
    factor = 1.0
    for i in range(poles):
        factor *= scale[0]
        c[i] *= factor
