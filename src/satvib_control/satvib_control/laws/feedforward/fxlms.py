# SPDX-FileCopyrightText: 2026 The satvib authors
# SPDX-License-Identifier: Apache-2.0
"""Filtered-x LMS, normalized and leaky, in its modified form.

The residual is y = d + G u with u = w^T phi. The gradient of y^2 / 2 for a filter that changes slowly is y phi_f, with
phi_f = G_hat phi. The modified form uses in the place of y

    e = d_hat + w^T phi_f,    d_hat = y - G_hat u_applied,

what the present weights would leave if they had been there all the time. So the delay of G is not in the loop of the
adaptation, and the bound of the step is that of plain NLMS, 0 < mu < 2, for any path. u_applied is the voltage that the
guard let out, so saturation and fading do not change the gradient.

    w <- (1 - mu q) w - mu e phi_f / max(|phi_f|^2, <|phi_f|^2>)

q is the leak. It is a ratio of powers, so it means the same for any disturbance: in a direction of the regressor with
the power p, of the total P, the stationary residual is q P / (p + q P) of the disturbance.

When G_hat is not G, e is wrong by (G - G_hat) u, and for small steps the weights follow w' = -mu G_hat^* (d + G w) at
each frequency. That is stable if and only if Re(G / G_hat) > 0, a phase error below 90 degrees (Morgan 1980, IEEE
Trans. ASSP 28, 454). Modified form: Bjarnason 1995, IEEE Trans. Speech and Audio Processing 3, 504; Elliott, Signal
Processing for Active Control, 2001, sections 3.4 and 3.5.
"""

from satvib_common.kernels.compile import kernel
from satvib_common.kernels.ordered_dot import dot_of

TINY = 1e-30


@kernel(
    'void(f8[:], f8, b1, f8, f8, f8, f8[:], f8[:], f8[:])',
    '(p),(),(),(),(),(),(p),(o)->()',
    writable=('weights', 'power'),
)
def fxlms(regressor, error, active, step, leak, share, weights, power, norm):
    """One step of the weights, in place.

    Args:
        regressor: (p) phi_f.
        error: () e, m/s^2.
        active: () bool; nothing changes where it is false.
        step: () mu, 0 to 2.
        leak: () q.
        share: () of the present sample in the mean power, 0 to 1.
        weights: (p) V/(m/s^2), changed.
        power: (1) mean of |phi_f|^2, changed; 0 before the first sample.
        norm: () out, 2-norm of the weights squared.
    """
    total = dot_of(regressor, regressor)
    good = active and total < 1e280 and abs(error) < 1e140
    if good:
        power[0] = total if power[0] == 0.0 else power[0] + share * (total - power[0])
        gain = step * error / (max(total, power[0]) + TINY)
        keep = 1.0 - step * leak
        for i in range(regressor.shape[0]):
            weights[i] = keep * weights[i] - gain * regressor[i]
    norm[0] = dot_of(weights, weights)
