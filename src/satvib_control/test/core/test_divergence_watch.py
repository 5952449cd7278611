# SPDX-FileCopyrightText: 2026 The satvib authors
# SPDX-License-Identifier: Apache-2.0
import numpy as np
import pytest
from satvib_common.phases import Phase, PhasePlan

RATE = 200.0
PLAN = PhasePlan(
    (Phase.STANDBY, Phase.IDENTIFY, Phase.STANDBY, Phase.CONTROL), (0, 1, 2, 400), 10**6
)
BAND = slice(int(2.0 * RATE), None)


def watched(make_loop, settings, plant, identified, trusted=True, **changes):
    p = settings(
        **({'sample_rate': RATE, 'law': 'velocity_feedback', 'velocity_gain': 1e6} | changes)
    )
    return make_loop(p, plant, PLAN, identified=identified, trusted=trusted)


def noise(seconds, level=0.3, seed=1):
    return level * np.random.default_rng(seed).standard_normal(int(seconds * RATE))


def test_a_law_on_a_wrong_model_is_taken_off_and_the_vibration_stays_small(
    make_isolator, make_loop, settings
):
    """A model with the wrong sign, and 2.7 times the gain that is stable with it. Truth: without the watch the
    voltage runs from limit to limit; with it the strut ends near its open loop, at a share of the gain."""
    model = make_isolator(RATE)
    plant = make_isolator(RATE, gain=-1.18)
    blind = watched(make_loop, settings, plant, model, watch_ratio=1e9)
    y_blind, u_blind = blind.run(int(40 * RATE), noise(40))
    assert np.mean(np.abs(u_blind[BAND]) == 20.0) > 0.4
    loop = watched(make_loop, settings, plant, model)
    y, u = loop.run(int(40 * RATE), noise(40))
    assert np.mean(np.abs(u[BAND]) == 20.0) < 0.1
    tail = slice(int(30 * RATE), None)
    assert y[tail].std() < 2.0 * 0.3
    assert y[tail].std() < 0.2 * y_blind[tail].std()


def test_the_cause_for_the_third_time_is_a_fault(make_isolator, make_loop, settings):
    """A gain so far beyond the bound that a quarter of it is unstable too. Truth: 0 V for good, and the reason."""
    model = make_isolator(RATE, gain=0.1)  # so the proven gain is twelve times too large
    loop = watched(make_loop, settings, make_isolator(RATE, gain=1.2), model)
    loop.run(int(30 * RATE), noise(30))
    _, out = loop.step(0.0)
    assert out.fault
    assert out.voltage == 0.0
    assert out.reason_text() == 'fault: the law made the vibration grow, three times in a row'
    loop.core.reset()
    _, out = loop.step(0.0)
    assert not out.fault


@pytest.mark.parametrize('known', [True, False], ids=['model', 'no model'])
def test_a_disturbance_that_grows_is_not_the_laws_fault(make_isolator, make_loop, settings, known):
    """Ten times the tone from 5 s on. Truth: the same run without the watch; alike to the last bit in the last 10 s.

    Without a model the law has to be taken off once to tell; with one it never is.
    """
    model = make_isolator(RATE)
    t = np.arange(int(30 * RATE)) / RATE
    d = np.sin(2 * np.pi * 10.0 * t) * np.where(t < 5.0, 0.1, 1.0)
    runs = []
    for ratio in (3.0, 1e9):
        loop = watched(
            make_loop,
            settings,
            model,
            model,
            known,
            watch_ratio=ratio,
            velocity_gain=150.0,
            velocity_fallback_gain=150.0,
        )
        runs.append(loop.run(len(t), d)[1])
    tail = slice(int(20 * RATE), None)
    np.testing.assert_allclose(runs[0][tail], runs[1][tail], rtol=1e-9, atol=1e-12)
    taken_off = np.any(runs[0][int(3 * RATE) :] == 0.0)
    assert taken_off != known


def test_a_pulse_does_not_take_the_law_off(make_isolator, make_loop, settings):
    """A half-sine of 5 m/s^2 and 50 ms on a lightly damped strut. Truth: as without the watch, to the last bit."""
    model = make_isolator(RATE, wn=56.5, zeta=0.05)
    t = np.arange(int(12 * RATE)) / RATE
    d = np.where((t > 6.0) & (t < 6.05), 5.0 * np.sin(np.pi * (t - 6.0) / 0.05), 0.0)
    runs = [
        watched(make_loop, settings, model, model, watch_ratio=r, velocity_gain=30.0).run(
            len(t), d
        )[1]
        for r in (3.0, 1e9)
    ]
    np.testing.assert_array_equal(runs[0], runs[1])
    assert np.max(np.abs(runs[0][BAND])) > 0.1
