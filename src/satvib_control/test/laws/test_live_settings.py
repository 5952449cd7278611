# SPDX-FileCopyrightText: 2026 The satvib authors
# SPDX-License-Identifier: Apache-2.0
"""Settings that change while a law acts: the voltage makes no step but by the ratio of gains, and nothing starts again.

Two loops are the same up to a sample. Before that sample one of them is given other settings.
"""

import numpy as np
import pytest
from satvib_common.phases import Phase, PhasePlan
from scipy.signal import lfilter

RATE = 200.0
PLAN = PhasePlan((Phase.CONTROL,), (0,))
COUNT = 1200
PID = {'law': 'model_reference', 'adapted_gains': ()}
ADAPTIVE = {'law': 'model_reference', 'adapt_in_control': True, 'gain_i': 20.0}
FILTER = {'law': 'feedforward', 'feedforward_struts': 1}


def vibration():
    """Two tones with noise at the payload, of which most comes through the lower plate (count), (count), m/s^2."""
    t = np.arange(COUNT + 1) / RATE
    noise = 0.02 * np.random.default_rng(5).standard_normal(COUNT + 1)
    lower = np.sin(2 * np.pi * 9.0 * t) + 0.6 * np.sin(2 * np.pi * 14.0 * t) + noise
    return lfilter([0.0, 0.8, 0.1], [1.0, -0.3], lower), lower


@pytest.fixture
def pair(make_isolator, make_loop, settings):
    """Two loops that have run `COUNT` samples of the vibration, and one more sample of each: the voltages."""

    def run(old, new):
        plant, (upper, lower) = make_isolator(RATE), vibration()
        p = settings(sample_rate=RATE, **old)
        loops = [make_loop(p, plant, PLAN, (), plant) for _ in range(2)]
        for loop in loops:
            loop.core.set_model(plant)
            _, u = loop.run(COUNT, upper, lower)
        loops[0].core.apply(p.replace(**new))
        after = [loop.step(upper[COUNT], lower[COUNT])[1] for loop in loops]
        return np.ravel(u), after, loops

    return run


@pytest.mark.parametrize(
    ('old', 'new', 'ratio'),
    [
        ({**PID, 'gain_i': 20.0}, {'gain_i': 30.0}, 1.5),
        ({**PID, 'gain_p': 0.2}, {'gain_p': 0.1}, 0.5),
        ({**PID, 'gain_i': 20.0, 'gain_p': 0.2}, {'gain_i': 10.0, 'gain_p': 0.1}, 0.5),
        ({'law': 'velocity_feedback', 'velocity_gain': 20.0}, {'velocity_gain': 30.0}, 1.5),
    ],
)
def test_a_gain_changes_the_voltage_by_the_ratio_of_the_gains(pair, old, new, ratio):
    """Truth: the laws are linear in their gains; relative tolerance 1e-12 for rounding."""
    u, (changed, same), _ = pair(old, new)
    assert np.max(np.abs(u)) > 0.05
    assert changed.voltage == pytest.approx(ratio * same.voltage, rel=1e-12)


def test_gains_that_are_set_stay_within_what_the_model_proves(pair):
    """Truth: the bound that the state shows; a gain within it is taken as it is."""
    _, (changed, _), (loop, _) = pair({**PID, 'gain_i': 20.0}, {'gain_i': 1e6})
    assert changed.state.ki == changed.state.ki_max < 1e6
    loop.core.apply(loop.core.parameters.replace(gain_i=10.0))
    assert loop.step()[1].state.ki == 10.0


def test_a_second_gain_can_be_set_where_there_was_one(pair):
    """Truth: a loop that had both gains from the start has the same gains, within 1e-9 of them."""
    _, (changed, _), _ = pair({**PID, 'gain_i': 20.0}, {'gain_p': 0.2})
    _, (_, both), _ = pair({**PID, 'gain_i': 20.0, 'gain_p': 0.2}, {})
    assert changed.state.kp == pytest.approx(both.state.kp, rel=1e-9)
    assert changed.state.ki == pytest.approx(both.state.ki, rel=1e-9)
    assert both.state.kp != 0.0


def test_the_start_of_a_gain_that_adapts_moves_nothing_at_once(pair):
    """Truth: the loop that was not told; every bit of voltage and gain. Leakage then leads to the new start."""
    resting = {**ADAPTIVE, 'adaptation_rule': 'mit', 'adaptation_rate': 0.0}
    _, (changed, same), (loop, _) = pair(resting, {'gain_i': 10.0})
    assert changed.voltage == same.voltage
    assert changed.state.ki == same.state.ki == 20.0
    loop.core.apply(loop.core.parameters.replace(adaptation_leakage=20.0))
    loop.run(400, *vibration())
    assert loop.step()[1].state.ki == pytest.approx(10.0, rel=1e-6)  # 40 time constants


@pytest.mark.parametrize(
    'new',
    [
        {'adaptation_rate': 2.0},
        {'adaptation_leakage': 0.5},
        {'adaptation_error_leakage': 0.5},
        {'adaptation_memory': 1.0},
        {'adaptation_floor': 0.5},
        {'adaptation_dead_zone': 0.1},
        {'adapt_in_control': False},
    ],
)
def test_settings_of_the_adaptation_act_on_the_gain_and_not_on_the_voltage(pair, new):
    """Truth: the voltage of a sample comes before its adaptation, so its bits are those of the loop not told."""
    _, (changed, same), (told, untold) = pair(ADAPTIVE, new)
    assert changed.voltage == same.voltage
    upper, lower = vibration()
    found = [loop.run(100, upper, lower)[1] for loop in (told, untold)]
    assert not np.array_equal(*found)  # and yet it was taken


@pytest.mark.parametrize(
    ('old', 'new'),
    [
        ({'law': 'narrowband'}, {'narrowband_settling': 0.2}),
        ({'law': 'narrowband', 'narrowband_settling': 0.3}, {'narrowband_settling': 0.15}),
        ({'law': 'narrowband'}, {'narrowband_memory': 1.0}),
        ({'law': 'narrowband'}, {'narrowband_smallest': 0.1}),
        (FILTER, {'feedforward_memory': 0.5}),
        (FILTER, {'feedforward_leak': 0.01}),
        ({**FILTER, 'feedforward_method': 'fxlms'}, {'feedforward_step': 0.4}),
        ({**FILTER, 'feedforward_method': 'fxlms'}, {'feedforward_leak': 0.01}),
        ({**FILTER, 'feedforward_method': 'fxlms'}, {'feedforward_floor': 0.5}),
    ],
)
def test_settings_of_a_canceller_make_no_step(pair, old, new):
    """Truth: the loop that was not told. A step is less than 1 % of the largest voltage of the last second."""
    u, (changed, same), (told, untold) = pair(old, new)
    largest = np.max(np.abs(u[-int(RATE) :]))
    assert largest > 0.5
    assert abs(changed.voltage - same.voltage) < 0.01 * largest
    upper, lower = vibration()
    found = [loop.run(400, upper, lower)[1] for loop in (told, untold)]
    if 'narrowband_smallest' not in new and 'feedforward_floor' not in new:
        assert not np.array_equal(*found)  # and yet it was taken


def test_a_smaller_limit_of_the_weights_is_a_ratio_of_gains(pair):
    """Truth: all weights become less by one factor, limit over norm; relative tolerance 1e-9 for rounding."""
    old = {**FILTER, 'feedforward_method': 'fxlms'}
    _, (changed, same), _ = pair(old, {'feedforward_weight_limit': 0.1})
    assert same.state.weight_norm > 0.1
    ratio = 0.1 / same.state.weight_norm
    assert changed.voltage == pytest.approx(ratio * same.voltage, rel=1e-9)


@pytest.mark.parametrize(
    'law',
    [PID | {'gain_i': 20.0}, ADAPTIVE, FILTER, {'law': 'narrowband'}, {'law': 'velocity_feedback+narrowband'}],
    ids=lambda p: p['law'],
)  # fmt: skip
def test_settings_that_are_the_same_change_no_bit(make_isolator, make_loop, settings, law):
    """Truth: a loop that is never told."""
    plant, (upper, lower) = make_isolator(RATE), vibration()
    p = settings(sample_rate=RATE, **law)
    told, untold = (make_loop(p, plant, PLAN, (), plant) for _ in range(2))
    for loop in (told, untold):
        loop.core.set_model(plant)
    for k in range(500):
        if k % 7 == 0:
            told.core.apply(p)
        u = [loop.step(upper[k], lower[k])[1].voltage for loop in (told, untold)]
        assert u[0] == u[1]
