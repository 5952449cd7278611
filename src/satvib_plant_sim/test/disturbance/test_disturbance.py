# SPDX-FileCopyrightText: 2026 The satvib authors
# SPDX-License-Identifier: Apache-2.0
"""Disturbances by kind."""

from itertools import pairwise

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from numpy.testing import assert_allclose, assert_array_equal
from satvib_common.errors import SatvibError
from satvib_plant_sim.disturbance import disturbance_kinds, make_disturbance
from satvib_plant_sim.disturbance.mixer import Mixer
from satvib_plant_sim.disturbance.sweep import step_values
from satvib_plant_sim.plant.plant import Plant
from satvib_plant_sim.rig.rig import load_rig
from scipy.signal import chirp, welch

N_FINE, H = 40, 1.0 / 4000.0
EXAMPLES = {
    'none': {},
    'sine': {'amplitude': 1.5, 'frequency': 10.0, 'phase': 30.0},
    'tones': {'amplitudes': [1.0, 0.5], 'frequencies': [10.0, 33.0], 'phases': [0.0, 90.0]},
    'sweep': {'amplitude': 1.0, 'frequency': 5.0, 'end_frequency': 40.0, 'duration': 2.0},
    'multisine': {'rms': 0.5, 'low': 2.0, 'high': 60.0, 'period': 2.0},
    'stepped_sine': {
        'amplitude': 1.0,
        'frequency': 5.0,
        'end_frequency': 40.0,
        'steps': 4,
        'dwell': 0.5,
    },
    'random': {'rms': 0.8, 'low': 2.0, 'high': 50.0},
    'reaction_wheel': {'speed': 10.0, 'harmonics': [1.0, 2.8], 'coefficients': [2e-4, 1e-4]},
    'mounted_wheel': {'speed': 10.0, 'axis': [0.0, 0.0, 2.0], 'axial': [2e-4]},
    'pulse': {'amplitude': 3.0, 'duration': 0.02},
    'trapezoid': {'amplitude': 2.0, 'rise': 0.1, 'hold': 0.2, 'fall': 0.3},
    'burst': {'amplitude': 2.0, 'frequency': 12.0, 'decay': 0.3},
    'sum': {'terms': [{'kind': 'pulse', 'amplitude': 1.0, 'duration': 0.5}]},
}


def unity(_):
    return 1.0


def values(settings, seconds, seed=1, transfer=unity):
    """Base values on the fine grid and their times."""
    disturbance = make_disturbance(settings)
    mixer = Mixer([disturbance], [seed], [transfer], H, N_FINE)
    periods = round(seconds / (N_FINE * H))
    found = np.concatenate([mixer.period(k)[0, 0, :-1] for k in range(periods)])
    return np.arange(len(found)) * H, found


def test_every_kind_has_an_example_here():
    """Truth: the factory's list."""
    assert sorted(EXAMPLES) == sorted(disturbance_kinds())


@pytest.mark.parametrize('kind', EXAMPLES)
def test_every_kind_survives_the_way_to_plain_data_and_back(kind):
    """Truth: the object itself; exact."""
    disturbance = make_disturbance({'kind': kind, **EXAMPLES[kind]})
    assert make_disturbance(disturbance.to_mapping()) == disturbance
    assert make_disturbance(disturbance) is disturbance


@pytest.mark.parametrize('kind', EXAMPLES)
def test_any_sample_in_any_order_gives_the_same_bits(kind):
    """Truth: the values in order; exact. Ends of periods meet the beginnings of the next."""
    disturbance = make_disturbance({'kind': kind, **EXAMPLES[kind]})
    mixer = Mixer([disturbance], [3], [unity], H, N_FINE)
    forward = [mixer.period(k)[0, 0] for k in range(600)]
    other = Mixer([disturbance], [3], [unity], H, N_FINE)
    for k in [599, 0, 411, 412, 3, 410, 599]:
        assert_array_equal(other.period(k)[0, 0], forward[k])
    for before, after in pairwise(forward):
        assert before[-1] == after[0]


@pytest.mark.parametrize('kind', EXAMPLES)
def test_start_and_stop(kind):
    """Truth: nothing before start and from stop on; in between the same as from zero, later by start, exact."""
    if kind == 'sum':
        return
    plain = make_disturbance({'kind': kind, **EXAMPLES[kind]}).to_mapping()
    _, later = values({**plain, 'start': 0.5, 'stop': 1.25}, 2.0)
    _, now = values(plain, 2.0)
    edges = round(0.5 / H), round(1.25 / H)
    assert_array_equal(later[: edges[0]], 0.0)
    assert_array_equal(later[edges[1] :], 0.0)
    assert_array_equal(later[edges[0] : edges[1]], now[: edges[1] - edges[0]])


def test_tones_are_sums_of_sines():
    """Truth: numpy's sine; 1e-13."""
    t, d = values({'kind': 'sine', **EXAMPLES['sine']}, 2.0)
    assert_allclose(d, 1.5 * np.sin(2 * np.pi * 10.0 * t + np.pi / 6), atol=1e-12)
    t, d = values({'kind': 'tones', **EXAMPLES['tones']}, 2.0)
    expected = np.sin(2 * np.pi * 10.0 * t) + 0.5 * np.cos(2 * np.pi * 33.0 * t)
    assert_allclose(d, expected, atol=1e-12)


@pytest.mark.parametrize('shape', ['linear', 'log'])
def test_sweeps_follow_scipys_chirp(shape):
    """Truth: scipy.signal.chirp during the sweep, the end frequency with an unbroken phase after it; 1e-10."""
    t, d = values({'kind': 'sweep', **EXAMPLES['sweep'], 'shape': shape}, 3.0)
    during = t <= 2.0
    method = {'linear': 'linear', 'log': 'logarithmic'}[shape]
    expected = chirp(t[during], 5.0, 2.0, 40.0, method=method, phi=-90.0)
    assert_allclose(d[during], expected, atol=1e-10)
    assert np.abs(np.diff(d)).max() < 2 * np.pi * 40.0 * H * 1.001
    crossings = np.flatnonzero((d[:-1] < 0) & (d[1:] >= 0) & (t[:-1] > 2.1))
    assert_allclose(np.mean(np.diff(crossings)) * H, 1 / 40.0, rtol=0.01)


def test_a_wheel_at_constant_speed():
    """Truth: C Omega^2 sin(h Omega t), Omega = 2 pi 10 rad/s; 1e-12."""
    t, d = values({'kind': 'reaction_wheel', **EXAMPLES['reaction_wheel']}, 2.0)
    omega = 2 * np.pi * 10.0
    expected = omega**2 * (2e-4 * np.sin(omega * t) + 1e-4 * np.sin(2.8 * omega * t))
    assert_allclose(d, expected, atol=1e-12)


def test_a_mounted_wheel_turns_its_force_and_torque():
    """Truth: a force of C Omega^2 in the plane of z and x that turns about y with Omega, M = p x F + torque; 1e-12."""
    wheel = make_disturbance(
        {'kind': 'mounted_wheel', 'speed': 10.0, 'axis': [0.0, 3.0, 0.0], 'position': [0.1, 0.0, -0.2],
         'harmonics': [1.0, 2.0], 'radial': [2e-4, 0.0], 'axial': [0.0, 3e-5], 'torque': [1e-5, 0.0],
         'target': 'payload', 'phases': [40.0, 0.0]}
    )  # fmt: skip
    assert wheel.tones() == (10.0, 20.0)
    mixer = Mixer([wheel], [1], [unity], H, N_FINE, (6, 6))
    found = np.concatenate([mixer.period(k)[0, :, :-1] for k in range(25)], axis=1)
    assert_array_equal(found[:6], 0.0)
    omega, t = 2 * np.pi * 10.0, np.arange(found.shape[1]) * H
    force, moment = found[6:9], found[9:]
    assert_allclose(np.hypot(force[0], force[2]), 2e-4 * omega**2, rtol=1e-12)
    assert_allclose(force[1], 3e-5 * omega**2 * np.sin(2 * omega * t), atol=1e-12)
    turned = np.unwrap(np.arctan2(force[0], force[2]))
    assert_allclose(np.diff(turned), omega * H, rtol=1e-9)
    # the torque turns with the force; it is 1e-5 / 2e-4 m of it, and the force acts at the wheel's place
    torque = 0.05 * force * [[1.0], [0.0], [1.0]]
    assert_allclose(moment, np.cross([0.1, 0.0, -0.2], force.T).T + torque, atol=1e-12)
    with pytest.raises(SatvibError, match='position: a wheel on the base has none'):
        make_disturbance({'kind': 'mounted_wheel', 'speed': 1.0, 'position': [0, 0, 1]})
    with pytest.raises(SatvibError, match='radial: 2 for 1 harmonics'):
        make_disturbance({'kind': 'mounted_wheel', 'speed': 1.0, 'radial': [1, 1]})


@settings(max_examples=30, deadline=None)
@given(speed=st.floats(1.0, 60.0), coefficient=st.floats(1e-6, 1e-2), harmonic=st.floats(0.3, 6.0))
def test_a_wheels_amplitude_is_c_omega_squared(speed, coefficient, harmonic):
    """Truth: C Omega^2, corrected by a made-up |T| = 1.25; the largest of 4000 points per second, 0.5 %."""
    settings_ = {'kind': 'reaction_wheel', 'speed': speed, 'harmonics': [harmonic]}
    _, d = values({**settings_, 'coefficients': [coefficient]}, 4.0, transfer=lambda _: 1.25)
    peak = coefficient * (2 * np.pi * speed) ** 2 / 1.25
    assert_allclose(np.abs(d).max(), peak, rtol=0.05 if harmonic * speed > 200 else 0.005)


def test_a_wheel_that_runs_up():
    """Truth: the phase as a cumulative trapezoid of the speed on a grid 50 times finer; 1e-6. No tones are fixed."""
    ramp = {'speed': 5.0, 'end_speed': 30.0, 'ramp_start': 0.5, 'ramp_time': 2.0}
    settings_ = {'kind': 'reaction_wheel', 'coefficients': [1e-3], **ramp}
    assert make_disturbance(settings_).tones() == ()
    t, d = values(settings_, 4.0)
    fine = np.arange(len(t) * 50) * H / 50
    speed = 2 * np.pi * np.interp(fine, [0.5, 2.5], [5.0, 30.0])
    theta = np.concatenate([[0.0], np.cumsum((speed[1:] + speed[:-1]) * H / 100)])[::50]
    assert_allclose(d, 1e-3 * speed[::50] ** 2 * np.sin(theta), atol=1e-5)


def test_shapes():
    """Truth: the formulas, at chosen instants; 1e-12."""
    t, d = values({'kind': 'pulse', **EXAMPLES['pulse']}, 1.0)
    assert_allclose(d, np.where(t < 0.02, 3.0 * np.sin(np.pi * t / 0.02), 0.0), atol=1e-12)
    t, d = values({'kind': 'trapezoid', **EXAMPLES['trapezoid']}, 1.0)
    assert_allclose(d, np.interp(t, [0.0, 0.1, 0.3, 0.6], [0.0, 2.0, 2.0, 0.0]), atol=1e-12)
    t, d = values({'kind': 'burst', **EXAMPLES['burst']}, 1.0)
    assert_allclose(d, 2.0 * np.exp(-t / 0.3) * np.sin(2 * np.pi * 12.0 * t), atol=1e-12)


@pytest.mark.parametrize('kind', ['pulse', 'trapezoid', 'burst'])
def test_shapes_repeat(kind):
    """Truth: the first period, again and again; 1e-9 (the place within a period is a difference)."""
    _, d = values({'kind': kind, **EXAMPLES[kind], 'period': 0.75}, 3.0)
    once = d[: round(0.75 / H)]
    assert_allclose(d, np.tile(once, 4), atol=1e-9)


@pytest.mark.parametrize(('low', 'high'), [(2.0, 50.0), (0.0, 20.0), (8.0, 12.0)])
def test_random_noise_has_its_rms_and_its_band(low, high):
    """Truth: the RMS asked for, 5 standard errors of 2 (high - low) 120 s numbers; 99 % of the power in the band."""
    _, d = values({'kind': 'random', 'rms': 0.8, 'low': low, 'high': high}, 120.0)
    error = np.sqrt(1.0 / (2.0 * 2.0 * (high - low) * 120.0))
    assert_allclose(np.sqrt(np.mean(d * d)), 0.8, rtol=5.0 * error)
    f, power = welch(d, 1.0 / H, nperseg=32768)
    margin = max(0.25 * low, 0.04 * high)
    inside = (f > low - margin) & (f < high + margin)
    assert power[inside].sum() > 0.99 * power.sum()
    # far outside, images of the knots included, less than 1e-5 of what is inside
    outside = f > 2.0 * high
    assert power[outside].max() < 1e-5 * power[inside].mean()
    flat = power[(f > low + 0.25 * margin) & (f < high - 0.25 * margin)]
    assert flat.min() > 0.2 * flat.mean()


def test_random_noise_depends_on_the_seed_and_on_its_place_in_a_sum():
    """Truth: same seed same bits; other seed, or other term of a sum, uncorrelated (below 0.2 for 960 numbers)."""
    noise = {'kind': 'random', **EXAMPLES['random']}
    _, one = values(noise, 10.0)
    assert_array_equal(values(noise, 10.0)[1], one)
    _, two = values(noise, 10.0, seed=2)
    assert abs(np.corrcoef(one, two)[0, 1]) < 0.2
    _, both = values({'kind': 'sum', 'terms': [noise, noise]}, 10.0)
    assert abs(np.corrcoef(one, both - one)[0, 1]) < 0.2
    assert np.std(both - one) == pytest.approx(0.8, rel=0.2)


def test_a_sum_is_the_sum_of_its_terms():
    """Truth: its terms one by one; 1e-15. Sums within sums count as their terms."""
    sine, burst = {'kind': 'sine', **EXAMPLES['sine']}, {'kind': 'burst', **EXAMPLES['burst']}
    _, together = values({'kind': 'sum', 'terms': [sine, {'kind': 'sum', 'terms': [burst]}]}, 1.0)
    assert_allclose(together, values(sine, 1.0)[1] + values(burst, 1.0)[1], atol=1e-15)
    whole = make_disturbance({'kind': 'sum', 'terms': [sine, {**sine, 'frequency': 3.0}]})
    assert whole.tones() == (3.0, 10.0)


def test_trials_do_not_see_each_other():
    """Truth: each trial alone; exact, whatever kinds stand beside it."""
    kinds = [make_disturbance({'kind': k, **EXAMPLES[k]}) for k in EXAMPLES]
    kinds.append(make_disturbance({'kind': 'sine', **EXAMPLES['sine'], 'target': 'payload'}))
    together = Mixer(kinds, list(range(len(kinds))), [unity] * len(kinds), H, N_FINE)
    for i, kind in enumerate(kinds):
        alone = Mixer([kind], [i], [unity], H, N_FINE)
        for k in (0, 1, 77):
            channels = alone.channels
            assert_array_equal(together.period(k)[i, :channels], alone.period(k)[0])


def test_a_force_on_the_payload_moves_the_payload_first():
    """Truth: F / m less the dampers' part C v / m at the end of a line of force over one fine step; 2e-3."""
    push = {'kind': 'trapezoid', 'target': 'payload', 'amplitude': 9.0}
    push |= {'rise': 1e-9, 'hold': 1.0, 'fall': 1.0}
    plant = Plant(load_rig('paper_3dof'), make_disturbance(push), 1)
    truth = plant.advance(np.zeros(3))
    # v = h / 2 after the line from 0 to 1 m/s^2
    assert_allclose(truth.upper[:, 1], 1.0 - 575.0 / 3.0 * H / 2, atol=2e-3)
    assert_array_equal(truth.upper[:, 0], 0.0)
    assert_allclose(truth.lower[:, 1], 575.0 * 3.0 / 4.0 * H / 2, atol=0.01)


BAD = {
    'kind: nothing known': ({'kind': 'earthquake'}, "kind: 'earthquake' is not known"),
    'no kind': ({'amplitude': 1.0}, 'kind: missing'),
    'not a mapping': ([1.0], 'a mapping with the key kind is expected'),
    'unknown key': (
        {'kind': 'sine', 'amplitude': 1.0, 'frequency': 1.0, 'freq': 2.0},
        'freq: no such key; did you mean frequency?',
    ),
    'missing key': ({'kind': 'sine', 'amplitude': 1.0}, 'frequency: missing'),
    'frequency 0': (
        {'kind': 'sine', 'amplitude': 1.0, 'frequency': 0.0},
        'frequency: 0.0 is not above 0.0 Hz',
    ),
    'stop before start': (
        {'kind': 'pulse', 'amplitude': 1.0, 'duration': 0.1, 'start': 2.0, 'stop': 1.0},
        'stop: 1.0 s is not after start, 2.0 s',
    ),
    'target': (
        {'kind': 'pulse', 'amplitude': 1.0, 'duration': 0.1, 'target': 'moon'},
        "target: 'moon' is not one of base, payload",
    ),
    'lengths': (
        {'kind': 'tones', 'amplitudes': [1.0], 'frequencies': [1.0, 2.0]},
        'amplitudes: 1 for 2 frequencies',
    ),
    'wheel lengths': (
        {'kind': 'reaction_wheel', 'speed': 1.0, 'coefficients': [1.0, 2.0]},
        'coefficients: 2 for 1 harmonics',
    ),
    'band': ({'kind': 'random', 'rms': 1.0, 'low': 5.0, 'high': 5.0}, 'high: 5.0 Hz is not above'),
    'log sweep': (
        {'kind': 'sweep', 'shape': 'log', 'amplitude': 1.0}
        | {'frequency': 5.0, 'end_frequency': 5.0, 'duration': 1.0},
        'end_frequency: a log sweep needs another one',
    ),
    'overlap': (
        {'kind': 'pulse', 'amplitude': 1.0, 'duration': 0.5, 'period': 0.1},
        'period: 0.1 s is shorter than the shape',
    ),
    'term': (
        {'kind': 'sum', 'terms': [{'kind': 'none'}, {'kind': 'sine', 'amplitude': 1.0}]},
        'disturbance: terms[1]: frequency: missing',
    ),
    'time of a sum': ({'kind': 'sum', 'start': 1.0, 'terms': []}, 'belong to its terms'),
    'NaN': (
        {'kind': 'sine', 'amplitude': float('nan'), 'frequency': 1.0},
        'amplitude: nan is not a finite number',
    ),
}


@pytest.mark.parametrize('case', BAD)
def test_what_is_wrong_is_told_by_name(case):
    """Truth: the message names the key."""
    settings_, message = BAD[case]
    with pytest.raises(SatvibError) as refused:
        make_disturbance(settings_)
    assert message in str(refused.value)
    assert '\n' not in str(refused.value)


def test_a_band_above_the_fine_grid_is_refused():
    """Truth: 40 points in a period of 1900 Hz."""
    noise = make_disturbance({'kind': 'random', 'rms': 1.0, 'high': 1900.0})
    with pytest.raises(SatvibError, match=r'high: 1900\.0 Hz needs a truth of 76000 points'):
        Plant(load_rig('paper_3dof'), noise, 1)


def test_a_multisine_has_its_lines_and_repeats():
    """Truth: the transform of one period: 0.5 m/s^2 RMS, equal lines from 2 to 60 Hz, corrected by |T| = 1.25; 1e-9."""
    settings_ = {'kind': 'multisine', **EXAMPLES['multisine']}
    t, d = values(settings_, 4.0, transfer=lambda _: 1.25)
    period = round(2.0 / H)
    assert_allclose(d[period:], d[:period], atol=1e-12)
    lines = 2 * np.abs(np.fft.rfft(d[:period])) / period
    expected = np.zeros_like(lines)
    expected[4:121] = 0.5 / 1.25 * np.sqrt(2 / 117)
    assert_allclose(lines, expected, atol=1e-9)
    assert np.abs(d).max() / d.std() < 1.7
    assert len(t) == 2 * period


def test_a_multisine_that_fits_no_grid_is_refused():
    """Truth: 0.33333 s are no whole number of quarter milliseconds."""
    with pytest.raises(SatvibError, match='no whole number of steps'):
        values({'kind': 'multisine', 'rms': 1.0, 'low': 3.0, 'high': 60.0, 'period': 0.33333}, 1.0)
    with pytest.raises(SatvibError, match='no multiple of'):
        make_disturbance({'kind': 'multisine', 'rms': 1.0, 'low': 1.1, 'high': 1.9, 'period': 1.0})


def test_a_stepped_sine_does_not_depend_on_how_its_times_are_asked_for():
    """Truth: one time after the other, each with the phase added up from the first step; bit for bit, backwards too."""
    times, steps = np.array([0.0, 1e9, 1e-3]), np.array([1.0, 5.0, 0.05, 60.0, 0.03])
    grid, whole, alone = np.arange(0.0, 2000.0, 7.0), *np.zeros((2, 286))
    for order in (1, -1):
        step_values(times, steps, 3.0, grid[::order].copy(), whole)
        for j, n in enumerate(grid[::order]):
            step_values(times, steps, 3.0, np.array([n]), alone[j : j + 1])
        assert_array_equal(whole, alone)
        assert np.ptp(whole) > 1.9


def test_a_stepped_sine_stays_at_its_frequencies():
    """Truth: numpy's sine with the phase added up step by step; 1e-9. Nothing after the last step."""
    disturbance = make_disturbance({'kind': 'stepped_sine', **EXAMPLES['stepped_sine']})
    assert_allclose(disturbance.frequencies(), [5.0, 10.0, 20.0, 40.0])
    t, d = values(disturbance, 3.0)
    turns = np.zeros_like(t)
    for i, f in enumerate([5.0, 10.0, 20.0, 40.0]):
        turns += f * np.clip(t - 0.5 * i, 0.0, 0.5)
    expected = np.where(t < 2.0, np.sin(2 * np.pi * turns), 0.0)
    assert_allclose(d[t < 2.0 - H], expected[t < 2.0 - H], atol=1e-9)
    assert_array_equal(d[t > 2.0 + H], 0.0)
