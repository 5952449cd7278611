# SPDX-FileCopyrightText: 2026 The satvib authors
# SPDX-License-Identifier: Apache-2.0
"""The old model stays where the new one is not trusted, also when the new one has another order."""

import numpy as np
import scipy.signal
from satvib_control.core.trusted_model import TrustedModel
from satvib_ident.models.iir_model import IirModel

DT = 0.005
LEFT = np.array([True, False])
BOTH = np.array([True, True])


def model(a, b, delay=1):
    """The same model for two struts."""
    return IirModel(np.tile(a, (2, 1)), np.tile(b, (2, 1)), delay, DT)


def test_the_filter_of_each_strut_is_that_of_its_last_trusted_model():
    """Truth: scipy.signal.lfilter on the model that the strut should have; 1e-12. The left one has four poles more."""
    kept = TrustedModel((2,))
    kept.take(model([-0.5], [2.0]), BOTH)
    long = np.array([-0.9, 0.3, 0.1, -0.2, 0.05])
    kept.take(model(long, [1.0, 0.5], 2), LEFT)
    voltage = np.random.default_rng(1).standard_normal((100, 2))
    effect = np.array([kept.effect(v).copy() for v in voltage])
    left = scipy.signal.lfilter([0.0, 0.0, 1.0, 0.5], [1.0, *long], voltage[:, 0])
    right = scipy.signal.lfilter([0.0, 2.0], [1.0, -0.5], voltage[:, 1])
    # the effect on the next sample is there as soon as the voltage is
    np.testing.assert_allclose(effect[:-1, 0], left[1:], atol=1e-12)
    np.testing.assert_allclose(effect[:-1, 1], right[1:], atol=1e-12)


def test_only_a_trusted_model_that_differs_is_news():
    """Truth: by hand. The same response with more zeros at the end is the same model."""
    kept = TrustedModel((2,))
    first = model([-0.5], [2.0])
    assert kept.news(first, LEFT).tolist() == [True, False]
    kept.take(first, LEFT)
    assert kept.known.tolist() == [True, False]
    assert kept.news(first, BOTH).tolist() == [False, True]
    assert not kept.news(model([-0.5, 0.0, 0.0], [2.0]), LEFT).any()
    assert kept.news(model([-0.5, 0.1], [2.0]), LEFT).tolist() == [True, False]


def test_without_a_model_there_is_no_effect():
    """Exact: 0."""
    kept = TrustedModel((2,))
    assert not kept.effect(np.array([1.0, -3.0])).any()
    assert not kept.known.any()
