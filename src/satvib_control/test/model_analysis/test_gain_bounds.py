# SPDX-FileCopyrightText: 2026 The satvib authors
# SPDX-License-Identifier: Apache-2.0
import numpy as np
import pytest
from hypothesis import assume, example, given, settings
from hypothesis import strategies as st
from satvib_common.signals.integrator import leaky_integrator
from satvib_control.model_analysis.gain_bounds import gain_bounds
from satvib_control.model_analysis.gain_projection import loop_grid, ray
from satvib_control.model_analysis.transfer import model_polynomials, multiply
from satvib_ident.models.iir_model import IirModel
from scipy.stats import chi2

MARGIN = 0.5
FREQUENCIES = np.geomspace(1e-4, 0.5, 20001)


def response(c, f):
    return np.polyval(np.asarray(c)[::-1], np.exp(-2j * np.pi * f))


def loop_of(model, cb, ca):
    b, a = model_polynomials(model)
    return multiply(b, cb), multiply(a, ca)


def worst_sensitivity(num, den, gain):
    """max |S| of u = -K C y, by brute force over 20001 frequencies."""
    return np.max(
        np.abs(1.0 / (1.0 + gain * response(num, FREQUENCIES) / response(den, FREQUENCIES)))
    )


def largest_pole(num, den, gain):
    length = max(len(num), len(den))
    c = np.zeros(length)
    c[: len(den)] += den
    c[: len(num)] += gain * num
    return np.max(np.abs(np.roots(c)), initial=0.0)


@st.composite
def plants(draw):
    """Stable plants with 2 to 4 poles, the slowest pair damped by at least 1 %, any polarity, delay 1 to 3."""
    pairs = draw(st.integers(1, 2))
    a = np.array([1.0])
    for _ in range(pairs):
        w = draw(st.floats(0.05, 2.5))
        zeta = draw(st.floats(0.01, 1.0))
        pole = np.exp(-zeta * w + 1j * w * np.sqrt(1 - zeta * zeta))
        a = np.convolve(a, [1.0, -2 * pole.real, abs(pole) ** 2])
    b = [draw(st.floats(-1.0, 1.0)) for _ in range(draw(st.integers(1, 4)))]
    assume(max(map(abs, b)) > 0.05)
    return IirModel(a[1:], b, draw(st.integers(1, 3)), 0.01)


# two resonances closer to each other than the grid's frequencies
TWINS = IirModel([-3.99300454, 5.98402231, -3.98901353, 0.998002], [0.0, 1.0], 2, 0.01)


@settings(max_examples=60, deadline=None)
@example(model=TWINS, share=0.5)
@given(model=plants(), share=st.floats(0.0, 0.999))
def test_inside_the_interval_the_loop_is_stable_with_the_margin(model, share):
    """Truth: closed-loop poles by numpy.roots and max |S| by brute force; 1e-3 for the brute grid."""
    cb, ca = leaky_integrator(0.5, model.dt)
    bounds = gain_bounds(model, cb, ca, MARGIN)
    num, den = loop_of(model, cb, ca)
    for bound in (bounds.minimum, bounds.maximum):
        gain = float(bound) * share
        assert largest_pole(num, den, gain) < 1.0
        assert worst_sensitivity(num, den, gain) <= (1.0 + 1e-3) / MARGIN


@settings(max_examples=60, deadline=None)
@given(model=plants())
def test_the_interval_is_the_largest_one(model):
    """Truth: a half per cent beyond either bound max |S| exceeds 2 on the brute grid."""
    cb, ca = leaky_integrator(0.5, model.dt)
    bounds = gain_bounds(model, cb, ca, MARGIN)
    num, den = loop_of(model, cb, ca)
    for bound in (bounds.minimum, bounds.maximum):
        if bound != 0.0:
            assert worst_sensitivity(num, den, 1.005 * float(bound)) > 1.0 / MARGIN


def test_a_gain_of_one_delay_has_the_closed_form():
    """L = K z^-1: |1 + K e^-jw| is smallest at w = pi for K > 0, so K_max = 1 - mu, and at w = 0 for K < 0."""
    model = IirModel([0.0], [1.0], 1, 0.01)
    bounds = gain_bounds(model, [1.0], [1.0], MARGIN)
    np.testing.assert_allclose(bounds.maximum, 0.5, rtol=1e-9)
    np.testing.assert_allclose(
        bounds.minimum, -0.5, rtol=1e-6
    )  # the grid begins at 1e-4 of the rate


def test_an_unstable_model_proves_nothing():
    model = IirModel([-1.1], [1.0], 1, 0.01)
    bounds = gain_bounds(model, [1.0], [1.0], MARGIN)
    assert bounds.minimum == 0.0
    assert bounds.maximum == 0.0


def test_nothing_is_proven_of_a_model_that_is_not_a_number():
    bounds = gain_bounds(IirModel([np.nan], [1.0], 1, 0.01), [1.0], [1.0], MARGIN)
    assert bounds.maximum == 0.0


def test_the_confidence_ellipsoid_narrows_the_interval_and_keeps_its_promise(make_isolator):
    """Truth: 300 random models on the surface of the 99 % ellipsoid, closed with the bound: all stable, |S| <= 2.1.

    The bound is of first order in the parameters, hence 5 % on |S|.
    """
    model = make_isolator(200.0)
    size = model.a.shape[-1] + model.b.shape[-1]
    rng = np.random.default_rng(3)
    root = rng.standard_normal((size, size)) * 2e-4
    covariance = root @ root.T
    cb, ca = leaky_integrator(0.5, model.dt)
    plain = gain_bounds(model, cb, ca, MARGIN)
    tube = gain_bounds(model, cb, ca, MARGIN, covariance, 0.99)
    assert 0.0 < tube.maximum < plain.maximum
    assert plain.minimum < tube.minimum < 0.0
    radius = np.sqrt(chi2.ppf(0.99, size))
    theta = np.concatenate([model.a, model.b])
    for _ in range(300):
        direction = rng.standard_normal(size)
        moved = theta + radius * root @ (direction / np.linalg.norm(direction))
        other = IirModel(moved[: model.a.shape[-1]], moved[model.a.shape[-1] :], 1, model.dt)
        num, den = loop_of(other, cb, ca)
        assert largest_pole(num, den, float(tube.maximum)) < 1.0
        assert worst_sensitivity(num, den, float(tube.maximum)) < 2.1


def test_the_batch_has_the_bits_of_its_items(make_isolator):
    """Truth: each item alone; equal to the last bit."""
    models = [make_isolator(200.0, wn=w) for w in (90.0, 131.0, 150.0)]
    batch = IirModel(np.stack([m.a for m in models]), np.stack([m.b for m in models]), 1, 0.005)
    cb, ca = leaky_integrator(0.5, 0.005)
    together = gain_bounds(batch, cb, ca, MARGIN)
    for i, model in enumerate(models):
        alone = gain_bounds(model, cb, ca, MARGIN)
        assert together.maximum[i] == alone.maximum
        assert together.minimum[i] == alone.minimum


@pytest.mark.parametrize(
    'direction', [(1, 0, 0), (0, 1, 0), (1e-3, 1, 0), (-2e-3, 1, 1e-6), (0, -1, 1e-5)]
)
def test_gains_on_a_ray_are_scaled_back_to_the_margin(make_isolator, direction):
    """Truth: poles by numpy.roots and max |S| by brute force; 2 % for the coarser grid of the ray."""
    model = make_isolator(200.0)
    b, a = model_polynomials(model)
    fb, fa = leaky_integrator(0.5, model.dt)
    rows = [
        multiply(b, fa),
        multiply(b, fb),
        multiply(multiply(b, fa), [1 / model.dt, -1 / model.dt]),
    ]
    den = multiply(a, fa)
    gains = ray(1e6 * np.array(direction), np.zeros(3), loop_grid(rows, den), MARGIN)
    total = np.zeros(len(rows[2]))
    for gain, row in zip(gains, rows, strict=True):
        total[: len(row)] += gain * row
    assert largest_pole(total, den, 1.0) < 1.0
    assert worst_sensitivity(total, den, 1.0) == pytest.approx(2.0, rel=0.02)
