# SPDX-FileCopyrightText: 2026 The satvib authors
# SPDX-License-Identifier: Apache-2.0
"""The recursive filter: its poles, its gradient, and that it finds a recursive optimum."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from satvib_control.laws.feedforward.filtered_u import stabilize
from satvib_control.laws.feedforward.regressor_kernel import Contents, RegressorState, run_regressor
from scipy.signal import lfilter


@given(st.lists(st.floats(-5.0, 5.0), min_size=1, max_size=6))
@settings(max_examples=200, deadline=None)
def test_poles_end_inside_the_circle(c):
    """Truth: numpy.roots. All poles below the radius (1e-6 for multiple roots), and untouched if they were there."""
    weights = np.array([7.0, *c])
    scale = stabilize(weights, len(c), 0.98)
    found = np.abs(np.roots([1.0, *(-weights[1:])]))
    before = np.abs(np.roots([1.0, *(-np.array(c))]))
    assert weights[0] == 7.0
    assert (found < 0.98 + 1e-6).all()
    if (before < 0.98 - 1e-6).all():
        assert scale == 1.0
        assert weights[1:].tolist() == c
    elif (before > 0.98 + 1e-6).any():
        np.testing.assert_allclose(np.sort(found), np.sort(scale * before), rtol=1e-4, atol=1e-4)


def test_a_pole_that_is_not_a_number_is_forgotten():
    """Truth: nothing is known of it, so C is 0. Exact."""
    weights = np.array([1.0, np.nan, 0.5])
    stabilize(weights, 2, 0.98)
    assert weights.tolist() == [1.0, 0.0, 0.0]


def drive(theta, x, num, den, taps):
    """u and y - d by SciPy for fixed weights: u = W / (1 - C) x, y = z^-1 num / den u."""
    u = lfilter(theta[:taps], np.concatenate([[1.0], -theta[taps:]]), x)
    return u, np.concatenate([[0.0], lfilter(num, den, u)[:-1]])


def test_the_regressor_is_the_gradient_of_the_residual():
    """Truth: central differences of a SciPy simulation with each weight moved; 1e-5 of the largest."""
    rng = np.random.default_rng(1)
    taps, poles, count = 4, 2, 120
    theta = np.array([0.5, -0.3, 0.2, 0.4, 0.9, -0.4])
    num, den = np.array([0.6, -0.2, 0.1]), np.array([1.0, -0.7, 0.3])
    x = rng.standard_normal(count)
    u = drive(theta, x, num, den, taps)[0]
    contents = Contents(taps, 0, poles)
    state = RegressorState.zeros(contents, reaction=1, path=3, shape=())
    for k in range(count):
        before = np.array([u[k - 1] if k else 0.0])
        run_regressor(
            x[k : k + 1], before, before, np.zeros(1), num, den, np.ones(3),
            np.array(contents), theta, *state,
        )  # fmt: skip
        assert state.regressor @ theta == pytest.approx(u[k], abs=1e-12)
    h = 1e-5
    for i in range(6):
        move = h * np.eye(6)[i]
        up = drive(theta + move, x, num, den, taps)[1]
        down = drive(theta - move, x, num, den, taps)[1]
        slope = (up[-1] - down[-1]) / (2 * h)
        assert state.gradient[i] == pytest.approx(slope, abs=1e-5 * np.abs(state.gradient).max())
