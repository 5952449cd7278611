# SPDX-FileCopyrightText: 2026 The satvib authors
# SPDX-License-Identifier: Apache-2.0
"""The kernels that several packages share, each against NumPy or SciPy."""

import numpy as np
import pytest
import scipy.signal
from satvib_common.kernels.compile import kernel
from satvib_common.kernels.direct_form import filter_sample
from satvib_common.kernels.horner_rule import horner, polynomial
from satvib_common.kernels.ordered_dot import dot
from satvib_common.kernels.schur_cohn import inside_circle, inside_unit_circle
from satvib_common.kernels.ud import column_product, measure_one


@kernel('void(f8[:], f8[:], f8[:], f8[:], f8[:])', '(m),(m),(s),(t)->(t)', writable=('state',))
def filtered(b, a, state, x, y):
    for k in range(x.shape[0]):
        y[k] = filter_sample(b, a, state, x[k])


@kernel('void(f8[:], c16, c16[:])', '(n),()->()')
def value(c, x, out):
    out[0] = horner(c, x)


@kernel('void(f8[:], f8, f8[:], b1[:])', '(n),()->(n),()')
def inside(c, radius, work, out):
    out[0] = inside_circle(c, radius, work)


@kernel('void(f8[:], f8[:], b1[:])', '(n)->(n),()')
def inside_one(c, work, out):
    work[:] = c
    out[0] = inside_unit_circle(work)


@kernel(
    'void(f8[:], f8, f8, f8[:], f8[:,:], f8[:], f8[:], f8[:])',
    '(p),(),(),(p),(p,p),(p)->(p),()',
    writable=('theta', 'U', 'd'),
)
def update(w, error, scale, theta, U, d, gain, alpha):
    alpha[0] = measure_one(w, error, scale, theta, U, d, gain)


@kernel('void(f8[:,:], f8[:], f8[:])', '(p,p),(p)->(p)')
def products(U, w, f):
    for j in range(w.shape[0]):
        f[j] = column_product(j, U, w)


@pytest.mark.parametrize('order', [0, 1, 2, 6])
@pytest.mark.parametrize('spare', [0, 2])
def test_filter_sample_equals_scipy(order, spare):
    """Truth: scipy.signal.lfilter, to 1e-12; a state with spare places gives the same bits."""
    rng = np.random.default_rng([1, order])
    b = rng.standard_normal(order + 1)
    a = np.concatenate([[1.0], 0.3 * rng.standard_normal(order)])
    x = rng.standard_normal((3, 100))
    got = filtered(b, a, np.zeros((3, max(order, 1) + spare)), x)
    np.testing.assert_allclose(got, scipy.signal.lfilter(b, a, x), rtol=1e-12, atol=1e-12)
    np.testing.assert_array_equal(got, filtered(b, a, np.zeros((3, max(order, 1))), x))


def test_dot_is_summed_in_order():
    """Truth: Python's float, added from the first product to the last. Exact."""
    a, b = np.random.default_rng(2).standard_normal((2, 5, 40)) * 10.0 ** np.arange(-20, 20)
    expected = []
    for row, other in zip(a.tolist(), b.tolist(), strict=True):
        total = 0.0
        for x, y in zip(row, other, strict=True):
            total += x * y
        expected.append(total)
    np.testing.assert_array_equal(dot(a, b), expected)


def test_horner_equals_polyval_and_itself_outside_kernels():
    """Truth: numpy.polyval, to 1e-12; `polynomial` on an array to 1e-15 of the largest term."""
    rng = np.random.default_rng(3)
    c, x = rng.standard_normal(8), np.exp(1j * rng.uniform(0.0, 6.0, 20))
    expected = np.polyval(c[::-1], x)
    np.testing.assert_allclose(value(c, x), expected, rtol=1e-12)
    np.testing.assert_allclose(polynomial(c, x), expected, rtol=1e-14)
    np.testing.assert_allclose(polynomial(c.tolist(), complex(x[0])), expected[0], rtol=1e-12)
    assert value(c[:0], x[0]) == 0.0


@pytest.mark.parametrize('order', [1, 2, 3, 4, 7])
def test_schur_cohn_agrees_with_the_roots(order):
    """Truth: numpy.roots, for 200 random polynomials whose largest root is not within 1e-6 of the circle."""
    rng = np.random.default_rng([4, order])
    c, largest = rng.standard_normal((200, order)), rng.uniform(0.5, 1.6, 200)
    drawn = np.array([np.abs(np.roots([1.0, *row])).max() for row in c])
    c *= (largest / drawn)[:, None] ** np.arange(1, order + 1)
    for radius in (0.8, 1.0, 1.3):
        clear = np.abs(largest - radius) > 1e-6
        got = inside(c, radius)[1]
        np.testing.assert_array_equal(got[clear], (largest < radius)[clear])
        assert len(set(got.tolist())) == 2
    np.testing.assert_array_equal(inside_one(c)[1], inside(c, 1.0)[1])
    assert not inside_one(np.full(order, np.nan))[1]


def test_ud_measurement_equals_the_covariance_form():
    """Truth: P - P w w^T P / (1 + w^T P w) with NumPy, to 1e-10; theta moves by K e."""
    rng = np.random.default_rng(5)
    p, scale = 4, 1.25
    U = np.triu(rng.standard_normal((p, p)), 1) + np.eye(p)
    d, w, theta = rng.uniform(0.5, 2.0, p), rng.standard_normal(p), rng.standard_normal(p)
    before = scale * U @ np.diag(d) @ U.T
    gain = before @ w / (1.0 + w @ before @ w)
    moved, factor, diagonal = theta.copy(), U.copy(), d.copy()
    got, alpha = update(w, 0.7, scale, moved, factor, diagonal)
    np.testing.assert_allclose(alpha, 1.0 + w @ before @ w, rtol=1e-12)
    np.testing.assert_allclose(got, gain, rtol=1e-10)
    np.testing.assert_allclose(moved, theta + 0.7 * gain, rtol=1e-10)
    after = before - np.outer(gain, w @ before)
    np.testing.assert_allclose(factor @ np.diag(diagonal) @ factor.T, after, rtol=1e-9, atol=1e-12)
    np.testing.assert_allclose(products(U, w), U.T @ w, rtol=1e-13)


@pytest.mark.parametrize(('size', 'error'), [(1e61, 1.0), (np.nan, 1.0), (1.0, 1e101)])
def test_ud_measurement_refuses_what_would_overflow(size, error):
    """Truth: nothing may change. Exact."""
    theta, U, d = np.ones(2), np.eye(2), np.ones(2)
    _, alpha = update(np.array([1.0, size]), error, 1.0, theta, U, d)
    assert alpha == -1.0
    np.testing.assert_array_equal(theta, 1.0)
    np.testing.assert_array_equal(U, np.eye(2))
    np.testing.assert_array_equal(d, 1.0)
