# SPDX-FileCopyrightText: 2026 The satvib authors
# SPDX-License-Identifier: Apache-2.0
"""What the tests of identification share."""

from pathlib import Path

import numpy as np
import pytest
from satvib_ident.estimators.regressor import IirRegressor
from satvib_ident.excitation import make_excitation
from satvib_ident.models.iir_model import IirModel


@pytest.fixture
def paper():
    """The paper's printed G(z): 100 Hz, no delay."""
    return IirModel([-0.460, 0.158], [0.061, -0.103, 0.033], 0, 0.01)


@pytest.fixture(scope='session')
def robot_arm():
    """Torque and acceleration of the measured robot arm."""
    path = Path(__file__).resolve().parents[3].parent / 'shared/data/robot_arm/robot_arm.csv'
    if not path.exists():
        pytest.skip(f'the measured record is not at {path}')
    data = np.genfromtxt(path, delimiter=',', names=True)
    return data['torque'], data['acceleration']


@pytest.fixture
def feed():
    """Run an estimator over a record: feed(estimator, y, u, n, m, delay)."""

    def run(estimator, y, u, n=2, m=3, delay=0):
        shape = y.shape[:-1]
        regressor = IirRegressor(n, m, delay, shape)
        for k in range(y.shape[-1]):
            late = u[..., k - delay] if k >= delay else np.full(shape, np.nan)
            w, target, full = regressor.step(y[..., k], late, 0.0)
            if not np.all(full):
                estimator.interrupt(~full)
            estimator.update(w, target, full)
        return estimator

    return run


@pytest.fixture
def records(paper):
    """Noisy records of the paper's model: records(trials, samples, noise, seed) -> y, u, each (trials, samples)."""

    def make(trials, samples, noise, seed, amplitude=1.0, clock=2):
        u = np.array(
            [
                make_excitation('prbs', amplitude=amplitude, dt=0.01, clock=clock, seed=s).samples(
                    samples
                )
                for s in range(trials)
            ]
        )
        generator = np.random.default_rng([seed, 1])
        return paper.simulate(u) + noise * generator.normal(size=u.shape), u

    return make


@pytest.fixture
def batch_least_squares():
    """Scipy's solution and the regressors: batch_least_squares(y, u, n, m, delay) -> theta, W, target."""
    from scipy.linalg import lstsq

    def solve(y, u, n, m, delay=0, weight=None):
        first = max(n, m - 1 + delay)
        past = [-y[first - i : len(y) - i] for i in range(1, n + 1)]
        late = [u[first - delay - i : len(u) - delay - i] for i in range(m)]
        W, target = np.column_stack(past + late), y[first:]
        root = np.ones(len(target)) if weight is None else np.sqrt(weight[-len(target) :])
        return lstsq(W * root[:, None], target * root)[0], W, target

    return solve
