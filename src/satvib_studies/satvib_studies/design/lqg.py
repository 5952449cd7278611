# SPDX-FileCopyrightText: 2026 The satvib authors
# SPDX-License-Identifier: Apache-2.0
"""LQG (H2): the linear controller that makes E[q'q + r u'u] least on a `DesignModel`.

    u = -K x_f,    x_f = x_p + M (y - C x_p),    x_p(k+1) = A x_f + B v

K from one Riccati equation, M from the other one:

    X = A'XA + Z'Z - A'XB (r I + B'XB)^-1 B'XA,    K = (r I + B'XB)^-1 B'XA
    P = APA' + Q - APC' (R + CPC')^-1 CPA',        M = PC' (R + CPC')^-1

u(k) uses y(k): the voltage of a sample takes effect after it. v is the applied voltage, so the estimate is right while
the guard limits, and before CONTROL.

Separation: with v = u the poles of the closed loop are those of A - B K and of A - A M C together.

Reference: Kwakernaak, Sivan, "Linear Optimal Control Systems" (1972), chapter 6.
"""

from dataclasses import dataclass

import numpy as np
from satvib_common.arrays import Array
from satvib_common.errors import SatvibError
from satvib_control.laws.state_space.matrices import Matrices

from satvib_studies.design.model import DesignModel


@dataclass(frozen=True)
class Lqg:
    """A design.

    Attributes:
        matrices: of the controller; its state is x_p.
        K: (n, s) regulator.
        M: (s, n) estimator.
        X, P: (s, s) the solutions of the two equations.
    """

    matrices: Matrices
    K: Array
    M: Array
    X: Array
    P: Array


def design_lqg(model: DesignModel, voltage_weight: float) -> Lqg:
    """Design a controller.

    Args:
        model: see `design_model`.
        voltage_weight: sqrt(r), the acceleration that counts as much as 1 V, m/s^2 per V.

    Raises:
        SatvibError: the equations have no solution at this precision, or the loop is not stable.
    """
    from scipy.linalg import LinAlgError, solve_discrete_are

    A, B, C = model.A, model.B, model.C
    weight = voltage_weight**2 * np.eye(B.shape[1])
    try:
        X = solve_discrete_are(A, B, model.Z.T @ model.Z, weight)
        P = solve_discrete_are(A.T, C.T, model.Q, model.R)
    except (LinAlgError, ValueError) as error:
        raise SatvibError(f'LQG: the Riccati equations have no solution: {error}') from None
    K = np.linalg.solve(weight + B.T @ X @ B, B.T @ X @ A)
    M = np.linalg.solve(model.R + C @ P @ C.T, C @ P).T
    through = np.eye(len(A)) - M @ C
    found = Matrices(A=A @ through, B=A @ M, C=-K @ through, D=-K @ M, E=B)
    for name, inner in (('regulator', A - B @ K), ('estimator', found.A)):
        radius = float(np.abs(np.linalg.eigvals(inner)).max())
        if not radius < 1.0:
            raise SatvibError(f'LQG: the {name} is not stable, its largest pole is {radius:.6g}')
    return Lqg(matrices=found, K=K, M=M, X=X, P=P)
