# SPDX-FileCopyrightText: 2026 The satvib authors
# SPDX-License-Identifier: Apache-2.0
"""Noise, bias, range and converters."""

from itertools import pairwise

import numpy as np
import pytest
from numpy.testing import assert_allclose, assert_array_equal
from satvib_plant_sim.disturbance import make_disturbance
from satvib_plant_sim.physics.noise import noise_floor, noise_model, quantum
from satvib_plant_sim.physics.sensor_chain import noise_intensity, sensor_chain
from satvib_plant_sim.plant.plant import Plant
from satvib_plant_sim.responses.continuous import frequency_response
from satvib_plant_sim.rig.rig import load_rig
from scipy.integrate import quad
from scipy.linalg import solve_continuous_lyapunov

NONE = make_disturbance(None)
G = 9.80665


def readings(rig, seeds, samples):
    """Upper and lower readings at rest, (trials, 2n, samples)."""
    plant = Plant(rig, NONE, seeds)
    rest = np.zeros((len(seeds), plant.struts))
    found = []
    for _ in range(samples):
        sample = plant.sample()
        found.append(np.concatenate([sample.upper, sample.lower], axis=1))
        plant.advance(rest)
    return np.stack(found, axis=-1)


def chain_gain(rig, f):
    """|G|^2 of sensor and anti-alias filter, from the textbook forms."""
    acquisition, sensor = rig.acquisition, rig.accelerometer
    butterworth = 1.0 / (1.0 + (f / acquisition.filter_corner) ** (2 * acquisition.filter_order))
    return butterworth / (1.0 + (f / sensor.bandwidth) ** 2)


def theory(rig, lag=0):
    """Covariance of the noise at the converter, lag samples apart, by integrating its spectrum."""
    sensor = rig.accelerometer
    # one-sided density of white noise that has noise_rms behind the sensor's first-order bandwidth
    density = sensor.noise_rms**2 / (sensor.bandwidth * np.pi / 2)
    spacing = lag * rig.acquisition.period
    edges = [0.0, 50.0, 200.0, 1000.0, 5000.0, 1e5]
    return sum(
        quad(
            lambda f: density * chain_gain(rig, f) * np.cos(2 * np.pi * f * spacing),
            a,
            b,
            limit=2000,
        )[0]
        for a, b in pairwise(edges)
    )


@pytest.mark.parametrize('name', ['paper_3dof', 'clean_3dof'])
def test_the_chain_is_a_butterworth_behind_a_lag(name):
    """Truth: |G|^2 of the textbook; from true to read acceleration, 1e-9 relative."""
    rig = load_rig(name)
    f = np.array([1.0, 10.0, 50.0, 70.0, 200.0])
    H = frequency_response(rig, f)
    n = rig.struts.count
    ratio = H[:, n + 1 :, n] / H[:, : n + 1, n]
    assert_allclose(np.abs(ratio) ** 2, np.repeat(chain_gain(rig, f)[:, None], n + 1, axis=1))


@pytest.mark.parametrize('name', ['paper_3dof', 'clean_3dof'])
def test_noise_has_the_covariance_of_its_spectrum(name):
    """Truth: the integral of the spectrum; 40 seeds x 6 channels x 200 samples: 4 standard errors."""
    changes = {'acquisition.input_bits': 0, 'accelerometer.zero_tolerance': 0.0}
    rig = load_rig(name, changes)
    y = readings(rig, range(40), 200)
    variance = theory(rig)
    for lag in (0, 1, 3):
        measured = np.mean(y[..., : 200 - lag] * y[..., lag:])
        # the products of a coloured sequence: the effective number is a third of the samples at worst
        error = variance * np.sqrt(2.0 / (y.size / 3))
        assert abs(measured - theory(rig, lag)) < 4.0 * error
    assert abs(np.mean(y)) < 4.0 * np.sqrt(variance / (y.size / 3))


@pytest.mark.parametrize('rate', [20.0, 100.0, 1000.0, 20e3])
@pytest.mark.parametrize('name', ['paper_3dof', 'clean_3dof', 'soft_3dof'])
def test_the_noise_model_is_stationary_at_any_rate(name, rate):
    """Truth: E P E' + L L' = P with P from scipy's Lyapunov solver; 1e-9 of the largest entry."""
    rig = load_rig(name, {'acquisition.sample_rate': rate})
    A, b, _ = sensor_chain(rig.accelerometer, rig.acquisition)
    P = solve_continuous_lyapunov(A, -noise_intensity(rig.accelerometer) * np.outer(b, b))
    E, L, start, _ = noise_model(rig)
    close = 1e-9 * np.abs(P).max()
    assert_allclose(E @ P @ E.T + L @ L.T, P, atol=close)
    assert_allclose(start @ start.T, P, atol=close)


def test_noise_is_stationary_from_the_first_sample():
    """Truth: the integral of the spectrum, at sample 0 alone; 3000 draws: 4 standard errors of a variance."""
    rig = load_rig('clean_3dof', {'acquisition.input_bits': 0, 'accelerometer.zero_tolerance': 0.0})
    first = readings(rig, range(500), 1)
    assert_allclose(np.var(first), theory(rig), rtol=4.0 * np.sqrt(2.0 / first.size))


def test_channels_and_seeds_are_independent():
    """Truth: no correlation; 6 channels x 2000 samples: below 5 / sqrt(n) of effectively n = 700."""
    rig = load_rig('paper_3dof', {'acquisition.input_bits': 0})
    y = readings(rig, [1, 2], 2000).reshape(12, -1)
    correlation = np.corrcoef(y) - np.eye(12)
    assert np.abs(correlation).max() < 5.0 / np.sqrt(700)


@pytest.mark.parametrize('name', ['paper_3dof', 'clean_3dof', 'soft_3dof'])
def test_noise_floor_is_what_a_plant_at_rest_shows(name):
    """Truth: the deviation of readings at rest, quantization included; 20 seeds x 6 channels x 300 samples: 3 %."""
    rig = load_rig(name)
    y = readings(rig, range(20), 300)
    deviation = np.sqrt(np.mean(np.var(y, axis=-1)))
    assert_allclose(deviation, noise_floor(rig), rtol=0.03)


def test_noise_floor_of_the_paper_rig_in_figures():
    """Truth: 10 mg in 100 Hz through a 50 Hz lag is 10 mg sqrt(50 / 150); the 12-bit step is 4.88 mg / sqrt 12."""
    rig = load_rig('paper_3dof')
    assert_allclose(quantum(rig), 10.0 / 4096 / 0.5 * G, rtol=1e-6)
    floor = np.hypot(10e-3 * G * np.sqrt(50.0 / 150.0), quantum(rig) / np.sqrt(12.0))
    assert_allclose(noise_floor(rig), floor, rtol=1e-9)


def test_bias_is_drawn_within_the_tolerance_and_stays():
    """Truth: +-0.1 V at 0.5 V/g is +-0.2 g, evenly; 600 draws: mean within 4 standard errors, beyond 0.19 g."""
    quiet = {'accelerometer.noise_rms': 0.0, 'acquisition.input_bits': 0}
    y = readings(load_rig('paper_3dof', quiet), range(100), 3)
    assert_array_equal(y[..., 0], y[..., 2])
    assert np.abs(y).max() <= 0.2 * G * (1 + 1e-6)
    assert np.abs(y).max() > 0.19 * G
    assert abs(np.mean(y)) < 4.0 * 0.2 * G / np.sqrt(3.0 * 600)


def test_bias_can_be_given():
    """Truth: the rig's own numbers, upper sensors first; exact but for the sums in volts, 1e-12."""
    bias = [0.1, -0.2, 0.3, 0.0, 0.5, -0.6]
    changes = {'accelerometer.bias': bias, 'accelerometer.noise_rms': 0.0}
    plant = Plant(load_rig('paper_3dof', {**changes, 'acquisition.input_bits': 0}), NONE, 1)
    assert_allclose(plant.sample().upper, bias[:3], atol=1e-12)
    assert_allclose(plant.sample().lower, bias[3:], atol=1e-12)


def test_readings_are_codes_of_the_converter():
    """Truth: (code lsb - 2.5 V) / sensitivity with whole codes, the nearest ones; 1e-9 of a code."""
    rig = load_rig('paper_3dof')
    exact = load_rig('paper_3dof', {'acquisition.input_bits': 0})
    coarse, fine = readings(rig, [3], 50), readings(exact, [3], 50)
    volts = coarse * rig.accelerometer.sensitivity + 2.5
    codes = volts / (10.0 / 4096)
    assert_allclose(codes, np.rint(codes), atol=1e-9)
    assert np.abs(coarse - fine).max() <= quantum(rig) / 2 * (1 + 1e-9)
    assert len(np.unique(codes)) > 3


def test_a_sensor_stops_at_its_range_and_a_converter_at_its_own():
    """Truth: +-4 g; with 1 V/g about 2.5 V the upper end is the converter's last code below 5 V."""
    quiet = {'accelerometer.noise_rms': 0.0, 'accelerometer.zero_tolerance': 0.0}
    shake = make_disturbance({'kind': 'sine', 'amplitude': 60.0, 'frequency': 5.0})
    plant = Plant(load_rig('paper_3dof', {**quiet, 'acquisition.input_bits': 0}), shake, 1)
    seen = []
    for _ in range(60):
        seen.append(plant.sample().lower[0])
        plant.advance(np.zeros(3))
    assert_allclose([max(seen), min(seen)], [4 * G, -4 * G], rtol=1e-6)

    double = {'accelerometer.sensitivity': 1.0 / G}
    plant = Plant(load_rig('paper_3dof', {**quiet, **double}), shake, 1)
    seen = []
    for _ in range(60):
        seen.append(plant.sample().lower[0])
        plant.advance(np.zeros(3))
    assert_allclose(max(seen), (5.0 - 10.0 / 4096 - 2.5) * G, rtol=1e-9)
    assert_allclose(min(seen), -4.0 * G, atol=quantum(plant.rigs[0]))


def test_asking_twice_gives_the_same():
    """Truth: a sample is one instant; exact."""
    plant = Plant(load_rig('paper_3dof'), NONE, 5)
    for _ in range(3):
        first, second = plant.sample(), plant.sample()
        assert first.sequence == second.sequence
        assert_array_equal(first.upper, second.upper)
        plant.advance(np.zeros(3))
