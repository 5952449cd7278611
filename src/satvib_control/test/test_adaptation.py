# SPDX-FileCopyrightText: 2026 The satvib authors
# SPDX-License-Identifier: Apache-2.0
"""The rule by itself, and Rohrs' counter-example."""

import numpy as np
import pytest
from satvib_control.adaptation import move
from scipy.linalg import expm

DT = 0.005


def rule(gamma=1.0, dead=0.0, sigma=0.0, nu=0.0):
    return np.array([DT, gamma, dead, sigma, nu])


def test_the_plain_rule_is_the_papers():
    """Truth: theta - T gamma e eta, by hand."""
    assert move(2.0, 0.0, 0.5, 3.0, 9.0, 0.0, rule(gamma=4.0)) == 2.0 - DT * 4.0 * 0.5 * 3.0


def test_the_normalized_rule_converges_at_its_rate():
    """Truth: e = eta (theta - 1) makes theta - 1 fall by (1 - gamma T) a sample, whatever eta; 1e-12."""
    theta = 0.0
    for _ in range(100):
        theta = float(move(theta, 0.0, 7.0 * (theta - 1.0), 7.0, 49.0, 1.0, rule(gamma=5.0)))
    assert theta - 1.0 == pytest.approx(-((1.0 - 5.0 * DT) ** 100), rel=1e-12)


def test_inside_the_dead_zone_nothing_moves():
    assert move(2.0, 0.0, 0.099, 3.0, 9.0, 0.0, rule(dead=0.1)) == 2.0
    assert move(2.0, 0.0, 0.101, 3.0, 9.0, 0.0, rule(dead=0.1)) == pytest.approx(
        2.0 - DT * 0.001 * 3.0
    )
    assert move(2.0, 0.0, -0.101, 3.0, 9.0, 0.0, rule(dead=0.1)) == pytest.approx(
        2.0 + DT * 0.001 * 3.0
    )


def test_leakage_pulls_to_rest():
    """Truth: by hand; sigma alone, and nu with |e|."""
    assert move(3.0, 1.0, 0.0, 1.0, 1.0, 0.0, rule(sigma=0.5)) == 3.0 - DT * 0.5 * 2.0
    assert move(3.0, 1.0, -2.0, 0.0, 1.0, 0.0, rule(nu=0.5)) == 3.0 - DT * 0.5 * 2.0 * 2.0


def rohrs(s, normalized=0.0, seconds=80.0, bound=np.inf):
    """Rohrs et al., IEEE TAC 30(9), 1985, section V: plant 2/(s+1) * 229/(s^2+30s+229), model 3/(s+3).

    u = theta_1 r - theta_2 y, both by the Lyapunov rule with rate 1; r = 2 and an output disturbance 0.5 sin 16.1 t.
    Gives max |y| over the run, theta_2 at the end. The plant is stepped exactly (zero-order hold, 5 ms).
    """
    a = np.array([[-1.0, 458.0, 0.0], [0.0, 0.0, 1.0], [0.0, -229.0, -30.0]])
    b = np.array([[0.0], [0.0], [1.0]])
    block = expm(np.block([[a, b], [np.zeros((1, 4))]]) * DT)
    phi, gam = block[:3, :3], block[:3, 3]
    x, ym, theta = np.zeros(3), 0.0, np.array([1.14, 0.65])
    decay, largest = np.exp(-3.0 * DT), 0.0
    rest = np.array([1.14, 0.65])
    powers = np.zeros(2)
    for k in range(int(seconds / DT)):
        y = x[0] + 0.5 * np.sin(16.1 * k * DT)
        largest = max(largest, abs(y))
        if largest > 100.0:
            break
        r = 2.0
        regressor = np.array([r, -y])
        u = theta @ regressor
        powers += 0.01 * (regressor**2 - powers)
        theta = move(theta, rest, y - ym, regressor, powers, normalized, s)
        theta = np.clip(theta, -bound, bound)
        x = phi @ x + gam * u
        ym = decay * ym + (1.0 - decay) * r
    return largest, theta[1]


def test_rohrs_counter_example_bursts_under_the_plain_rule():
    """Truth: their simulation: the feedback gain drifts with the disturbance until the loop bursts (17 and up)."""
    largest, gain = rohrs(rule())
    assert largest > 100.0
    assert gain > 16.0


@pytest.mark.parametrize(
    ('s', 'bound'),
    [
        (rule(sigma=0.1), np.inf),
        (rule(nu=0.1), np.inf),
        (rule(dead=0.6), np.inf),
        (rule(), 10.0),
    ],
    ids=['sigma', 'e1', 'dead zone', 'projection'],
)
def test_rohrs_counter_example_is_harmless_under_the_robust_rules(s, bound):
    """Truth: the loop with the unmodelled modes is stable for gains below 17.03 (Routh); 400 s, |y| below 5."""
    largest, gain = rohrs(s, seconds=400.0, bound=bound)
    assert largest < 5.0
    assert gain < 17.0
