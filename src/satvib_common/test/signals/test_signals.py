# SPDX-FileCopyrightText: 2026 The satvib authors
# SPDX-License-Identifier: Apache-2.0
"""Filters and running figures, against SciPy and closed forms."""

import numpy as np
import pytest
import scipy.signal
from hypothesis import given
from hypothesis import strategies as st
from satvib_common.signals.calibration import BiasCalibration
from satvib_common.signals.iir_filter import IirFilter
from satvib_common.signals.integrator import LeakyIntegrator, leaky_integrator
from satvib_common.signals.statistics import MovingRms


@pytest.mark.parametrize('order', [0, 1, 2, 5])
def test_filter_equals_scipy(order):
    """Truth: scipy.signal.lfilter, another implementation of the same structure; 1e-12 relative."""
    rng = np.random.default_rng([1, order])
    b = rng.standard_normal(order + 1)
    a = np.concatenate([[2.0], 0.3 * rng.standard_normal(order)])
    x = rng.standard_normal((200, 3))
    ours = IirFilter(b, a, (3,))
    got = np.array([ours.step(row) for row in x])
    np.testing.assert_allclose(got, scipy.signal.lfilter(b, a, x, axis=0), rtol=1e-12, atol=1e-12)


def test_bits_do_not_depend_on_the_batch():
    """Truth: the same filter alone. Exact."""
    rng = np.random.default_rng(2)
    a = np.concatenate([np.ones((500, 3, 1)), 0.2 * rng.standard_normal((500, 3, 4))], axis=-1)
    b = rng.standard_normal((500, 3, 5))
    x = rng.standard_normal((50, 500, 3))
    batch = IirFilter(b, a, (500, 3))
    together = np.array([batch.step(row) for row in x])
    for trial, strut in [(0, 0), (17, 2), (499, 1)]:
        single = IirFilter(b[trial, strut], a[trial, strut])
        alone = np.array([single.step(v) for v in x[:, trial, strut]])
        np.testing.assert_array_equal(alone, together[:, trial, strut])


@given(st.floats(0.05, 2.0), st.floats(-20.0, 20.0))
def test_integrator_does_not_drift(corner, bias):
    """Truth: H has a zero at z = 1, so a bias leaves nothing after the start-up (30 time constants)."""
    dt = 0.005
    integrator = LeakyIntegrator(corner, dt)
    for _ in range(int(30.0 / (2.0 * np.pi * corner * dt)) + 1):
        v = integrator.velocity(np.asarray(bias))
    assert abs(v) <= 1e-8 * max(abs(bias), 1e-6) / corner


def test_integrator_integrates():
    """Truth: |H| = w / (w^2 + w_l^2) and phase -90 deg + 2 atan(w_l / w) before Tustin's warping (2 %)."""
    corner, dt, f = 0.2, 0.005, 10.0
    _, h = scipy.signal.freqz(*leaky_integrator(corner, dt), worN=[2 * np.pi * f * dt])
    s = 2j * np.pi * f
    want = s / (s + 2 * np.pi * corner) ** 2
    assert abs(h[0] / want - 1) < 0.02


@given(st.lists(st.floats(-1e3, 1e3), min_size=2, max_size=60))
def test_calibration_equals_numpy(values):
    """Truth: numpy's two-pass mean and deviation; 1e-9 of the largest value."""
    bias = BiasCalibration()
    for value in values:
        bias.add(np.asarray(value))
    bias.add(np.asarray(np.nan))
    scale = max(1e-9, float(np.max(np.abs(values))))
    assert abs(bias.mean - np.mean(values)) <= 1e-9 * scale
    assert abs(bias.standard_deviation - np.std(values, ddof=1)) <= 1e-6 * scale


def test_moving_rms_equals_its_definition():
    """Truth: the definition, computed anew at each sample; 1e-12."""
    rng = np.random.default_rng(3)
    x = rng.standard_normal((100, 2))
    rms = MovingRms(7, (2,))
    for k, row in enumerate(x):
        want = np.sqrt(np.mean(x[max(0, k - 6) : k + 1] ** 2, axis=0))
        np.testing.assert_allclose(rms.add(row), want, rtol=1e-12)
