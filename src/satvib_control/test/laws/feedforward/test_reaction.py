# SPDX-FileCopyrightText: 2026 The satvib authors
# SPDX-License-Identifier: Apache-2.0
"""The learnt reaction, and when it is used."""

import numpy as np
import pytest
from satvib_control.laws.feedforward.reaction import FREQUENCIES, ReferenceProtection, loop_gain
from satvib_control.laws.feedforward.regressor_kernel import Contents, response_table
from satvib_ident.excitation import make_excitation
from scipy.signal import freqz, lfilter

REACTION = np.array([-0.004, 0.003, 0.015, -0.02, 0.001, 0.005])


def squares(count, rate=200.0):
    return make_excitation('squares', amplitude=10.0, dt=1 / rate).samples(count)


def learn(lower, applied, taps=8, valid=None):
    protection = ReferenceProtection(taps, ())
    for k in range(len(lower)):
        on = True if valid is None else valid[k]
        protection.learn(lower[k], applied[k], np.array(on))
    return protection, protection.finish()


def test_it_finds_the_reaction_under_noise_and_vibration():
    """Ten seconds of squares with 1 mm/s^2 of noise and a tone of 0.05 m/s^2 from below, off the squares' harmonics.

    Truth: the taps that made the record. Three standard deviations of least squares, s sqrt((Phi^T Phi)^-1), where s
    counts tone and noise.
    """
    rng = np.random.default_rng(1)
    u = squares(2000)
    other = 0.001 * rng.standard_normal(2000) + 0.05 * np.sin(0.23 * np.arange(2000))
    protection, used = learn(lfilter(REACTION, [1.0], u) + other, u)
    assert used
    phi = np.stack([np.concatenate([np.zeros(i), u[: 2000 - i]]) for i in range(8)], axis=-1)
    spread = other.std() * np.sqrt(np.diag(np.linalg.inv(phi.T @ phi)))
    wanted = np.concatenate([REACTION, [0.0, 0.0]])
    assert (np.abs(protection.reaction - wanted) < 3.0 * spread + 1e-5).all()
    # and the magnitude on the grid is that of the taps
    response = np.abs(freqz(protection.reaction, 1.0, 2 * np.pi * FREQUENCIES)[1])
    np.testing.assert_allclose(protection.magnitude, response, rtol=1e-9, atol=1e-12)


@pytest.mark.parametrize('seed', range(20))
def test_noise_is_not_taken_for_a_reaction(seed):
    """Truth: there is none. Exactly nothing is used."""
    rng = np.random.default_rng([2, seed])
    protection, used = learn(0.1 * rng.standard_normal(1000), squares(1000))
    assert not used
    assert not protection.reaction.any()


def test_nothing_is_learnt_from_too_few_or_missing_samples():
    """Truth: with fewer than ten samples a tap nothing is used, and none with the sensor missing. Exact."""
    u = squares(400)
    lower = lfilter(REACTION, [1.0], u)
    assert not learn(lower[:60], u[:60])[1]
    assert not learn(lower, u, valid=np.zeros(400, dtype=bool))[1]
    assert not learn(lower, u, taps=0)[1]
    assert learn(lower, u)[1]


def test_the_loop_gain_is_the_largest_of_w_times_f():
    """Truth: scipy.signal.freqz of the filter with taps and poles. 1e-9 relative."""
    taps, poles = np.array([2.0, -1.0, 0.5]), np.array([0.6, -0.2])
    table = response_table(Contents(3, 0, 2), 0.5, 0.005, FREQUENCIES)
    reaction = np.abs(freqz(REACTION, 1.0, 2 * np.pi * FREQUENCIES)[1])
    w = freqz(taps, np.concatenate([[1.0], -poles]), 2 * np.pi * FREQUENCIES)[1]
    found = loop_gain(np.concatenate([taps, poles]), table, 2, reaction)
    assert found == pytest.approx((np.abs(w) * reaction).max(), rel=1e-9)
