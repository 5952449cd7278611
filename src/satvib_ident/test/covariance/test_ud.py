# SPDX-FileCopyrightText: 2026 The satvib authors
# SPDX-License-Identifier: Apache-2.0
"""The factored covariance against dense linear algebra."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from satvib_ident.covariance import ud
from satvib_ident.covariance.eigenvalues import (
    extreme_eigenvalues,
    information_measures,
    is_positive,
    rotate,
)


@pytest.fixture
def factors():
    """Random factors of a well-conditioned P, (U, d, P)."""

    def make(seed, p=5):
        generator = np.random.default_rng([11, seed])
        U = np.eye(p) + np.triu(generator.normal(size=(p, p)), 1)
        d = generator.uniform(0.5, 2.0, p)
        return U, d, U @ np.diag(d) @ U.T

    return make


def test_the_assembled_matrix_is_symmetric_to_the_last_bit_and_lifted_by_rounding_only(factors):
    """Truth: numpy's product; the documented lift of the diagonal is 4.5e-14 for five parameters."""
    U, d, P = factors(0)
    ours = ud.covariance(U, d)
    assert np.array_equal(ours, ours.T)
    np.testing.assert_allclose(ours, P, rtol=1e-13)


@pytest.mark.parametrize('forgetting', [1.0, 0.9])
@pytest.mark.parametrize('seed', range(5))
def test_a_measurement_is_equations_25_to_27(factors, forgetting, seed):
    """Truth: Theorem 4.1 in dense matrices (1e-12)."""
    U, d, P = factors(seed)
    generator = np.random.default_rng([12, seed])
    w, theta, error = generator.normal(size=5), generator.normal(size=5), 0.7
    Pb = P / forgetting
    K = Pb @ w / (1.0 + w @ Pb @ w)
    expected = theta + K * error, Pb - np.outer(K, w @ Pb)
    gain, alpha = ud.measure(w, error, forgetting, 1e9, True, theta, U, d)
    np.testing.assert_allclose(gain, K, rtol=1e-12)
    np.testing.assert_allclose(theta, expected[0], rtol=1e-12)
    np.testing.assert_allclose(ud.covariance(U, d), expected[1], rtol=1e-11, atol=1e-12)
    assert float(alpha) == pytest.approx(1.0 + w @ Pb @ w, rel=1e-12)


def test_forgetting_stops_at_the_limit(factors):
    """Truth: with a trace at the limit lambda is raised to 1, so P only shrinks."""
    U, d, P = factors(1)
    limit = float(np.trace(P))
    for _ in range(100):
        ud.measure(np.zeros(5), 0.0, 0.5, limit, True, np.zeros(5), U, d)
    assert np.trace(ud.covariance(U, d)) == pytest.approx(limit, rel=1e-12)


@pytest.mark.parametrize('rows', [1, 2, 5])
def test_forgetting_in_a_subspace(factors, rows):
    """Truth: P + (1/lambda - 1) V (V^T P^-1 V)^-1 V^T in dense matrices (1e-11); all directions: P / lambda."""
    U, d, P = factors(2)
    generator = np.random.default_rng([13, rows])
    V = generator.normal(size=(rows, 5))
    R = np.linalg.inv(P)
    expected = P + (1 / 0.8 - 1) * V.T @ np.linalg.inv(V @ R @ V.T) @ V
    padded = np.zeros((5, 5))
    padded[:rows] = V
    ud.forget_within(padded, 0.8, 1e9, True, U, d)
    np.testing.assert_allclose(ud.covariance(U, d), expected, rtol=1e-11)
    if rows == 5:
        np.testing.assert_allclose(expected, P / 0.8, rtol=1e-11)


def test_what_is_orthogonal_to_the_subspace_is_kept(factors):
    """Truth: the new information R' equals R along every x with x^T R V = 0 (1e-11)."""
    U, d, P = factors(3)
    R = np.linalg.inv(P)
    v = np.array([1.0, 0.5, 0.0, -1.0, 2.0])
    ud.forget_within(np.vstack([v, np.zeros((4, 5))]), 0.5, 1e9, True, U, d)
    after = np.linalg.inv(ud.covariance(U, d))
    assert v @ after @ v == pytest.approx(0.5 * (v @ R @ v), rel=1e-11)
    x = np.array([1.0, 0.0, 0.0, 0.0, 0.0])
    x = x - v * (v @ R @ x) / (v @ R @ v)
    np.testing.assert_allclose(after @ x, R @ x, rtol=1e-9, atol=1e-11)


@settings(max_examples=60, deadline=None)
@given(
    st.lists(st.floats(-1e12, 1e12), min_size=4, max_size=4),
    st.sampled_from([0.0, 1e-300, 1.0, 1e12]),
)
def test_any_measurement_leaves_a_positive_definite_matrix(w, scale):
    """Truth: Cholesky succeeds in double precision, which proves it."""
    U, d = ud.fresh(np.full(4, 1e18), ())
    theta = np.zeros(4)
    for _ in range(3):
        ud.measure(np.array(w) * scale, 1.0, 0.95, 1e18, True, theta, U, d)
        P = ud.covariance(U, d)
        assert np.array_equal(P, P.T)
        np.linalg.cholesky(P)
        assert np.isfinite(theta).all()


@pytest.mark.parametrize('bad', [np.nan, np.inf, 1e200])
def test_what_cannot_be_squared_is_refused_and_changes_nothing(factors, bad):
    """Truth: alpha = -1 and the same bits as before."""
    U, d, _ = factors(4)
    theta = np.ones(5)
    before = U.copy(), d.copy(), theta.copy()
    w = np.ones(5)
    w[2] = bad
    _, alpha = ud.measure(w, 0.1, 0.9, 1e9, True, theta, U, d)
    assert float(alpha) == -1.0
    for now, then in zip((U, d, theta), before, strict=True):
        assert np.array_equal(now, then)


def test_extreme_eigenvalues_equal_lapacks():
    """Truth: numpy.linalg.eigvalsh (1e-12 of the largest)."""
    generator = np.random.default_rng([14])
    for p in (1, 2, 5, 9):
        A = generator.normal(size=(20, p, p))
        A = A + np.swapaxes(A, -1, -2)
        values = np.linalg.eigvalsh(A)
        low, high = extreme_eigenvalues(A)
        size = np.abs(values).max()
        np.testing.assert_allclose(low, values[:, 0], atol=1e-12 * size)
        np.testing.assert_allclose(high, values[:, -1], atol=1e-12 * size)


def test_rotations_give_eigenvectors_and_pivots_tell_definiteness():
    """Truth: by construction, eigenvalues 4, 1, 1e-6 along a random orthonormal basis (1e-9)."""
    Q = np.linalg.qr(np.random.default_rng([15]).normal(size=(3, 3)))[0]
    A = Q @ np.diag([4.0, 1.0, 1e-6]) @ Q.T
    D, V = A.copy(), np.eye(3)
    rotate(D, V)
    order = np.argsort(-np.diag(D))
    np.testing.assert_allclose(np.diag(D)[order], [4.0, 1.0, 1e-6], atol=1e-12)
    np.testing.assert_allclose(np.abs(V[order] @ Q), np.eye(3), atol=1e-9)
    for shift, positive in ((0.0, True), (0.9e-6, True), (1.1e-6, False), (2.0, False)):
        assert is_positive(A - shift * np.eye(3), 0.0) is positive
    assert not is_positive(np.full((2, 2), np.nan), 0.0)


def test_information_measures_do_not_depend_on_units(factors):
    """Truth: dense inverse scaled to unit diagonal (1e-10), and the same after a change of units."""
    U, d, P = factors(5)
    R = np.linalg.inv(P)
    scaled = R / np.sqrt(np.outer(np.diag(R), np.diag(R)))
    values = np.linalg.eigvalsh(scaled)
    low, condition = information_measures(U, d)
    assert float(low) == pytest.approx(values[0], rel=1e-10)
    assert float(condition) == pytest.approx(values[-1] / values[0], rel=1e-10)
    units = np.array([1e3, 1.0, 1e-3, 10.0, 0.1])
    other = information_measures(units[:, None] * U / units, d * units**2)
    assert float(other[0]) == pytest.approx(float(low), rel=1e-9)
