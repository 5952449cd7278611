# SPDX-FileCopyrightText: 2026 The satvib authors
# SPDX-License-Identifier: Apache-2.0
"""The rule by itself, and Rohrs' counter-example."""

import numpy as np
import pytest
from satvib_control.laws.model_reference.adaptation import move
from satvib_control.laws.model_reference.rohrs import simulate

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


def test_rohrs_counter_example_bursts_under_the_plain_rule():
    """Truth: their simulation: the feedback gain drifts with the disturbance until the loop bursts (17 and up)."""
    y, theta = simulate(80.0)
    assert np.max(np.abs(y)) > 100.0
    assert theta[-1, 1] > 16.0


@pytest.mark.parametrize(
    'robust',
    [{'sigma': 0.1}, {'nu': 0.1}, {'dead_zone': 0.6}, {'bound': 10.0}],
    ids=['sigma', 'e1', 'dead zone', 'projection'],
)
def test_rohrs_counter_example_is_harmless_under_the_robust_rules(robust):
    """Truth: the loop with the hidden poles is stable for gains below 17.03 (Routh); 200 s, |y| below 5."""
    y, theta = simulate(200.0, **robust)
    assert len(y) == 40000
    assert np.max(np.abs(y)) < 5.0
    assert np.max(theta[:, 1]) < 17.0
