# SPDX-FileCopyrightText: 2026 The satvib authors
# SPDX-License-Identifier: Apache-2.0
"""Rohrs' counter-example: what unmodelled dynamics do to an adaptive law, and what stops it.

Rohrs, Valavani, Athans, Stein, "Robustness of continuous-time adaptive control algorithms in the presence of unmodeled
dynamics", IEEE Transactions on Automatic Control 30(9), 1985, section V:

    plant  2 / (s + 1) * 229 / (s^2 + 30 s + 229), taken for its first factor;    model 3 / (s + 3)
    u = theta_1 r - theta_2 y,  both by the Lyapunov rule;  r = 2, and 0.5 sin 16.1 t on the output

The disturbance cannot be cancelled, so theta_2 drifts until the loop with the hidden poles is unstable (17.03, Routh).
The gains move by `satvib_control.laws.model_reference.adaptation`; the plant is stepped exactly, under zero-order hold.
"""

import numpy as np
from satvib_common.arrays import Array
from scipy.linalg import expm

from satvib_control.laws.model_reference.adaptation import Rule, move

DT = 0.005  # s
START = (1.14, 0.65)  # theta_1, theta_2; what the model would need without the hidden poles is near
UNSTABLE = 17.03
BURST = 100.0  # |y| at which a run ends


def simulate(
    seconds: float,
    dead_zone: float = 0.0,
    sigma: float = 0.0,
    nu: float = 0.0,
    bound: float = np.inf,
) -> tuple[Array, Array]:
    """Run the example until its end, or until it bursts.

    Args:
        seconds: length.
        dead_zone: of the error.
        sigma: leakage, 1/s.
        nu: e1 modification.
        bound: projection of |theta|.

    Returns:
        y (t) and theta (t, 2), by samples of DT.
    """
    a = np.array([[-1.0, 458.0, 0.0], [0.0, 0.0, 1.0], [0.0, -229.0, -30.0]])
    b = np.array([[0.0], [0.0], [1.0]])
    block = expm(np.block([[a, b], [np.zeros((1, 4))]]) * DT)
    x, model, theta = np.zeros(3), 0.0, np.array(START)
    decay, reference = float(np.exp(-3.0 * DT)), 2.0
    rule = Rule(dt=DT, rate=1.0, dead_zone=dead_zone, leakage=sigma, error_leakage=nu)
    outputs, gains = [], []
    for k in range(round(seconds / DT)):
        y = float(x[0]) + 0.5 * float(np.sin(16.1 * k * DT))
        outputs.append(y)
        gains.append(theta)
        if abs(y) > BURST:
            break
        regressor = np.array([reference, -y])
        u = float(theta[0] * regressor[0] + theta[1] * regressor[1])
        theta = move(theta, np.array(START), y - model, regressor, np.zeros(2), 0.0, rule)
        theta = np.minimum(np.maximum(theta, -bound), bound)
        x = block[:3, :3] @ x + block[:3, 3] * u
        model = decay * model + (1.0 - decay) * reference
    return np.array(outputs), np.array(gains)
