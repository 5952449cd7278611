# SPDX-FileCopyrightText: 2026 The satvib authors
# SPDX-License-Identifier: Apache-2.0
import numpy as np
from hypothesis import assume, given, settings
from hypothesis import strategies as st
from hypothesis.extra.numpy import arrays
from satvib_control.model_analysis.transfer import (
    broadcast_model,
    model_polynomials,
    multiply,
    stable,
    value,
)
from satvib_ident.models.iir_model import IirModel

COEFFICIENTS = st.floats(-2.0, 2.0)


@settings(max_examples=300, deadline=None)
@given(c=arrays(float, st.integers(1, 7), elements=COEFFICIENTS))
def test_stability_agrees_with_the_roots(c):
    """Truth: numpy.roots, where the largest root is not within 1e-6 of the circle."""
    a = np.concatenate([[1.0], c])
    largest = np.max(np.abs(np.roots(a)), initial=0.0)
    assume(abs(largest - 1.0) > 1e-6)
    assert stable(a) == float(largest < 1.0)


@settings(max_examples=50, deadline=None)
@given(
    p=arrays(float, st.integers(1, 6), elements=COEFFICIENTS),
    q=arrays(float, st.integers(1, 6), elements=COEFFICIENTS),
)
def test_products_agree_with_convolution(p, q):
    """Truth: numpy.convolve, 1e-12."""
    np.testing.assert_allclose(multiply(p, q), np.convolve(p, q), atol=1e-12)


def test_the_model_as_polynomials_has_its_response():
    """Truth: IirModel.frequency_response; 1e-12."""
    model = IirModel([-0.46, 0.158], [0.061, -0.103, 0.033], 2, 0.01)
    b, a = model_polynomials(model)
    assert len(a) == len(b) == 5
    zi = np.exp(-2j * np.pi * 10.0 * 0.01)
    np.testing.assert_allclose(
        value(b, zi) / value(a, zi), model.frequency_response(10.0), rtol=1e-12
    )


def test_a_model_is_spread_over_a_batch():
    model = broadcast_model(IirModel([0.1], [1.0], 1, 0.01), (4, 3))
    assert model.a.shape == (4, 3, 1)
    assert model.shape == (4, 3)
