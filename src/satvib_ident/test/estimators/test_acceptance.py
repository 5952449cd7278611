# SPDX-FileCopyrightText: 2026 The satvib authors
# SPDX-License-Identifier: Apache-2.0
"""What identification must give back: the paper's printed model, a known plant, and a measured record."""

from pathlib import Path

import numpy as np
import pytest
import scipy.linalg
from satvib_ident.estimators.least_squares import RecursiveLeastSquares
from satvib_ident.models.iir_model import IirModel

RECORD = Path(__file__).resolve().parents[5] / 'shared/data/robot_arm/robot_arm.csv'
PAPER = IirModel([-0.460, 0.158], [0.061, -0.103, 0.033], 0, 0.01)


def regressors(y, u, n, m, delay):
    """Rows of Eq. (32) written out by index, independent of IirRegressor; the first row is sample n."""
    first = max(n, m + delay - 1)
    past = [-y[first - i : len(y) - i] for i in range(1, n + 1)]
    inputs = [u[first - delay - i : len(y) - delay - i] for i in range(m)]
    return np.stack(past + inputs, axis=-1), y[first:]


def recursive(w, y):
    estimator = RecursiveLeastSquares(w.shape[1])
    for row, value in zip(w, y, strict=True):
        estimator.update(row, value)
    return estimator.theta


@pytest.mark.parametrize(
    ('method', 'pole', 'damping', 'frequency'),
    [('tustin', -104.08 + 80.15j, 0.792, 131.4), ('zoh', -92.3 + 95.4j, 0.695, 132.7)],
)
def test_the_printed_model_in_continuous_time(method, pole, damping, frequency):
    """Truth: the paper's d2c figures (Tustin) and z = exp(sT) by hand; to the digits printed."""
    poles = PAPER.to_continuous(method).poles()
    upper = poles[np.argmax(np.imag(poles))]
    digits = 0.005 if method == 'tustin' else 0.05
    assert abs(upper.real - pole.real) <= digits
    assert abs(upper.imag - pole.imag) <= digits
    assert abs(PAPER.damping(method) - damping) <= 0.0005
    assert abs(PAPER.natural_frequency(method) - frequency) <= 0.05


def test_a_plant_without_noise_gives_back_its_parameters():
    """Truth: the parameters that made the record; 1e-6."""
    u = np.random.default_rng(1).choice([-5.0, 5.0], 400)
    y = PAPER.simulate(u)
    w, target = regressors(y, u, 2, 3, 0)
    np.testing.assert_allclose(recursive(w, target), PAPER.theta, atol=1e-6)


@pytest.mark.parametrize(('order', 'fit'), [(2, 0.9085), (4, 0.9967), (6, 0.9986)])
def test_robot_arm_equals_batch_least_squares(order, fit):
    """Truth: scipy's batch least squares on the measured record, 1e-9 relative; the record's published fits."""
    if not RECORD.is_file():
        pytest.skip('the measured record is not here: ../shared/data/robot_arm')
    data = np.genfromtxt(RECORD, delimiter=',', names=True)
    w, y = regressors(data['acceleration'], data['torque'], order, order + 1, 0)
    batch, *_ = scipy.linalg.lstsq(w, y)
    theta = recursive(w, y)
    assert np.linalg.norm(theta - batch) <= 1e-9 * np.linalg.norm(batch)
    achieved = 1.0 - np.linalg.norm(y - w @ theta) / np.linalg.norm(y - np.mean(y))
    assert abs(achieved - fit) <= 0.00005
