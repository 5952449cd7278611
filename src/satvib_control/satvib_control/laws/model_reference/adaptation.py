# SPDX-FileCopyrightText: 2026 The satvib authors
# SPDX-License-Identifier: Apache-2.0
"""How a gain moves: the MIT rule, its normalized form and what makes either robust.

The MIT rule (the paper: dtheta/dt = -gamma e de/dtheta) with e = y - y_m and eta = dy/dtheta, per sample of T:

    theta <- theta - T gamma g(e) eta / n - T (sigma + nu |e|) (theta - theta_0)

    n = 1 (MIT) or max(eta^2, <eta^2>) (normalized: then gamma is the rate of convergence in 1/s)
    g(e) = e, or with a dead zone d: e - d sign(e) outside |e| <= d, 0 inside
    sigma: leakage (Ioannou, Kokotovic 1983); nu: e1 modification (Narendra, Annaswamy 1987)

The Lyapunov rule (Parks 1966) has the same form with the regressor phi in the place of eta. It is stable where the path
from theta phi to e is strictly positive real, which a sampled plant with a delay never is. So leakage, dead zone and
projection are necessary. Rohrs et al. (IEEE TAC 30(9), 1985) is the counter-example that the tests run.
"""

from typing import NamedTuple

from satvib_common.kernels.compile import kernel


class Rule(NamedTuple):
    """Settings of the rule; `numpy.array` of it is what `move` takes.

    Attributes:
        dt: s; T.
        rate: gamma.
        dead_zone: of the error.
        leakage: 1/s; sigma.
        error_leakage: nu.
    """

    dt: float
    rate: float
    dead_zone: float
    leakage: float
    error_leakage: float


@kernel('void(f8, f8, f8, f8, f8, f8, f8[:], f8[:])', '(),(),(),(),(),(),(s)->()')
def move(theta, rest, e, eta, power, normalized, settings, out):
    """Gain after one sample, before any projection.

    Args:
        theta: the gain.
        rest: where leakage pulls it to.
        e: error.
        eta: its derivative with respect to the gain, or the regressor for the Lyapunov rule.
        power: <eta^2>.
        normalized: 0 or 1.
        settings: see `Rule`.
        out: the gain.
    """
    rule = Rule(settings[0], settings[1], settings[2], settings[3], settings[4])
    size = abs(e)
    effective = 0.0
    if size > rule.dead_zone:
        effective = e - rule.dead_zone if e > 0.0 else e + rule.dead_zone
    step = rule.rate * effective * eta
    if normalized != 0.0:
        n = max(eta * eta, power)
        step = step / n if n > 0.0 else 0.0
    leak = rule.leakage + rule.error_leakage * size
    out[0] = theta - rule.dt * step - rule.dt * leak * (theta - rest)
