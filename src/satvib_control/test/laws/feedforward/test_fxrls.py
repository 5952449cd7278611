# SPDX-FileCopyrightText: 2026 The satvib authors
# SPDX-License-Identifier: Apache-2.0
"""The least squares of feedforward against batch least squares, and how they last."""

from copy import deepcopy

import numpy as np
import pytest
from satvib_control.laws.feedforward.fxrls import LeastSquares


def run(phi, d, share, leak, pace=1.0, active=None, state=None):
    """Weights after the rows of phi (t, p) and d (t), and the least squares of the end."""
    p = phi.shape[1]
    w, squares = state or (np.zeros(p), LeastSquares(p))
    for k, row in enumerate(phi):
        on = True if active is None else active[k]
        squares.step(w, row, d[k] + w @ row, row @ row, on, pace=pace, leak=leak, share=share)
    return w, squares


def test_it_is_exponentially_weighted_ridge_regression():
    """Truth: numpy.linalg.solve on the weighted normal equations, with the lines "weight j is 0" in turn and the prior
    of the first sample. 1e-9 relative.
    """
    rng = np.random.default_rng(1)
    phi, d = rng.standard_normal((300, 5)) * [1, 2, 0.5, 1, 3], rng.standard_normal(300)
    share, leak = 0.02, 0.01
    w = run(phi, d, share, leak)[0]
    power = phi[0] @ phi[0]
    information = np.eye(5) * leak * power / (5 * share)
    aim = np.zeros(5)
    for k, row in enumerate(phi):
        if k:
            power += share * (row @ row - power)
        information = (1 - share) * information + np.outer(row, row)
        aim = (1 - share) * aim - row * d[k]
        information[k % 5, k % 5] += leak * power
    np.testing.assert_allclose(w, np.linalg.solve(information, aim), rtol=1e-9)


def test_p_stays_positive_and_bounded_on_a_tone():
    """A tone excites 2 of 20 weights; plain forgetting lets P grow by e^(10^5 / 200) here.

    Truth: P = U D U^T is positive definite with D > 0, and the leak bounds its trace by about p / rho; a factor of 3
    for the lines coming in turn.
    """
    k = np.arange(100_000)
    x = np.sin(2 * np.pi * 0.05 * k)
    phi = np.stack([np.roll(x, i) for i in range(20)], axis=-1)[20:]
    share, leak = 1 / 200, 1e-3
    w, squares = run(phi, x[20:], share, leak)
    assert (squares.d > 0).all()
    P = squares.U @ np.diag(squares.d) @ squares.U.T
    assert np.linalg.eigvalsh(P).min() > 0
    rho = leak * squares.power / (20 * share)
    assert np.trace(P) < 3 * 20 / rho
    # and the tone is cancelled to the share of the leak: q P / p over the half of P in each direction
    left = np.abs(x[-100:] + phi[-100:] @ w).max()
    assert left == pytest.approx(leak * 2 / 20, rel=0.1)


def test_weights_that_are_not_needed_fade():
    """Truth: with a silent half of the regressor its weights go to nothing: below 1e-6 after 30 memories."""
    rng = np.random.default_rng(3)
    first = rng.standard_normal((400, 4))
    state = run(first, first @ [1.0, -2.0, 3.0, -4.0], 0.02, 1e-3)
    assert abs(state[0]).min() > 0.9
    later = first.copy()
    later[:, 2:] = 0.0
    for _ in range(4):
        state = run(later, later @ [1.0, -2.0, 3.0, -4.0], 0.02, 1e-3, state=state)
    assert abs(state[0][2:]).max() < 1e-6
    assert abs(state[0][:2]).min() > 0.9


def test_pace_slows_the_correction():
    """Truth: from one state the correction scales with the pace; 1e-6 relative, the leak being 1e-9."""
    rng = np.random.default_rng(6)
    phi, d = rng.standard_normal((101, 3)), rng.standard_normal(101)
    state = run(phi[:100], d[:100], 0.02, 1e-9)
    moved = []
    for pace in (1.0, 0.25):
        copies = deepcopy(state)
        moved.append(run(phi[100:], d[100:], 0.02, 1e-9, pace=pace, state=copies)[0] - state[0])
    np.testing.assert_allclose(moved[1], 0.25 * moved[0], rtol=1e-6)


def test_inactive_and_absurd_samples_change_nothing():
    """Truth: the state as it was. Exact."""
    rng = np.random.default_rng(4)
    phi, d = rng.standard_normal((60, 4)), rng.standard_normal(60)
    w, squares = run(phi, d, 0.02, 1e-3)
    kept = deepcopy((w, squares))
    how = {'pace': 1.0, 'leak': 1e-3, 'share': 0.02}
    for error, active in ((1.0, False), (np.nan, True), (1e200, True)):
        squares.step(w, phi[0], error, phi[0] @ phi[0], active, **how)
    squares.step(w, phi[0] * np.nan, 1.0, np.nan, True, **how)
    assert np.array_equal(w, kept[0])
    for name in ('U', 'd', 'power'):
        assert np.array_equal(getattr(squares, name), getattr(kept[1], name))
    # the next j too: the next sample does what it would have done
    after = [run(phi[:1], d[:1], 0.02, 1e-3, state=state)[0] for state in ((w, squares), kept)]
    assert np.array_equal(*after)


def test_bits_do_not_depend_on_the_batch():
    """Truth: the items one by one. Exact."""
    rng = np.random.default_rng(5)
    phi, d = rng.standard_normal((80, 2, 3, 6)), rng.standard_normal((80, 2, 3))
    w, squares = np.zeros((2, 3, 6)), LeastSquares(6, (2, 3))
    how = {'pace': 1.0, 'leak': 1e-3, 'share': 0.02}
    for k in range(80):
        squares.step(w, phi[k], d[k], phi[k, ..., 0] ** 2, True, **how)
    for i in np.ndindex(2, 3):
        one, alone = np.zeros(6), LeastSquares(6)
        for k in range(80):
            alone.step(one, phi[k][i], d[k][i], phi[k][i][0] ** 2, True, **how)
        assert np.array_equal(one, w[i])
        assert np.array_equal(alone.U, squares.U[i])
