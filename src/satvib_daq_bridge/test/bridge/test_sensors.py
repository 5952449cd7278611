# SPDX-FileCopyrightText: 2026 The satvib authors
# SPDX-License-Identifier: Apache-2.0
"""Conversion, faults of sensors, and their bias. Truth: closed forms and the rules of the docstrings."""

import math

import numpy as np
import pytest
from satvib_common.errors import SatvibError
from satvib_common.files.yaml_file import load_yaml
from satvib_daq_bridge.bridge.bias import SensorBias, save_bias
from satvib_daq_bridge.bridge.sensors import Sensors

RATE = 100.0


def readings(rng, count, channels=2, bias=0.0, noise=0.005):
    return 2.5 + bias + noise * rng.standard_normal((count, channels))


def test_volts_become_accelerations(make_channels):
    """Truth: CXL04LP1, 0.5 V/g, 2.5 V at 0 g: 3.0 V is one g, -1 g when mounted upside down."""
    inputs = make_channels(struts=1, sensor={'sensitivity': 0.5 / 9.80665}).inputs
    assert Sensors(inputs, RATE).acceleration(np.array([3.0, 2.5])) == pytest.approx([9.80665, 0.0])
    turned = make_channels(struts=1, sensor={'sensitivity': 0.5 / 9.80665, 'polarity': -1}).inputs
    assert Sensors(turned, RATE).acceleration(np.array([3.0, 2.5]))[0] == pytest.approx(-9.80665)


def test_a_living_sensor_is_no_fault(make_channels):
    sensors = Sensors(make_channels(struts=1).inputs, RATE)
    rng = np.random.default_rng([1, 0])
    assert not any(sensors.watch(v) for v in readings(rng, 5000))


@pytest.mark.parametrize(
    ('value', 'after', 'said'),
    [
        (math.nan, 1, 'strut_1.lower reads no number at nan V'),
        (math.inf, 1, 'strut_1.lower reads no number at inf V'),
        (2147.0, 1, 'strut_1.lower is beyond what its converter can give, at 2147 V'),
        (-5.2, 1, 'strut_1.lower is beyond what its converter can give, at -5.2 V'),
        (4.999, 5, 'strut_1.lower is railed at 4.999 V'),
        (-5.0, 5, 'strut_1.lower is railed at -5 V'),
        (2.6, 50, 'strut_1.lower is stuck at 2.6 V'),
    ],
)
def test_a_sick_sensor_is_named_after_so_many_samples(make_channels, value, after, said):
    """Truth: at once for no number, 5 samples railed, 0.5 s of one value at 100 Hz."""
    sensors = Sensors(make_channels(struts=1).inputs, RATE)
    rng = np.random.default_rng([2, 0])
    found = []
    for reading in readings(rng, after):
        reading[1] = value
        found.append(sensors.watch(reading))
    assert found == [''] * (after - 1) + [said]


def test_an_impossible_reading_is_no_acceleration(make_channels):
    """Truth: a converter of +-5 V cannot give 2147 V; at the end of its range it can."""
    sensors = Sensors(make_channels(struts=1).inputs, RATE)
    impossible, possible = sensors.acceleration(np.array([2147.0, -5.0]))
    assert math.isnan(impossible)
    assert math.isfinite(possible)


def test_one_railed_sample_is_no_fault(make_channels):
    sensors = Sensors(make_channels(struts=1).inputs, RATE)
    for k, reading in enumerate(readings(np.random.default_rng([3, 0]), 100)):
        if k % 5:
            reading[0] = 5.0
        assert not sensors.watch(reading)


@pytest.mark.parametrize('polarity', [1, -1])
def test_readings_beyond_the_range_of_the_sensor_are_marked(make_channels, polarity):
    """Truth: 4 g of 0.5 V/g about 2.5 V are 0.5 and 4.5 V, far from the ends of a converter of +-5 V; the mark begins
    half a percent of the range before them. The sensor's own zero, 0.1 V off, moves both ends by 0.1 V."""
    sensor = {'sensitivity': 0.050986, 'sensor_range': 39.2266, 'polarity': polarity}
    sensors = Sensors(make_channels(struts=1, sensor=sensor).inputs, RATE)
    ends = 0.050986 * 39.2266 * 0.995
    volts = np.array([-ends - 1e-6, -ends + 1e-6, 0.0, ends - 1e-6, ends + 1e-6])
    for offset in (0.0, 0.1):
        bias = sensors.acceleration(np.full(2, 2.5 + offset))
        found = [sensors.clipped(np.full(2, 2.5 + offset + v), bias)[0] for v in volts]
        assert found == [True, False, False, False, True]


def test_gravity_uses_up_a_part_of_the_range(make_channels):
    """Truth: a sensor of 4 g that rests at 1 g clips 3 g above its rest and 5 g below it."""
    g = 9.80665
    sensor = {'sensitivity': 0.5 / g, 'sensor_range': 4 * g, 'rest': g}
    sensors = Sensors(make_channels(struts=1, sensor=sensor).inputs, RATE)
    bias = np.full(2, g)
    volts = 2.5 + 0.5 * np.array([3.97, 3.99, -3.97, -3.99])
    assert [sensors.clipped(np.full(2, v), bias)[0] for v in volts] == [False, True, False, True]


def test_without_a_range_only_the_ends_of_the_converter_are_marked(make_channels):
    sensors = Sensors(make_channels(struts=1, sensor={'sensor_range': 0.0}).inputs, RATE)
    zero = np.zeros(2)
    assert [sensors.clipped(np.full(2, v), zero)[0] for v in (0.5, 4.5, 4.96, -4.96)] == [
        False, False, True, True,
    ]  # fmt: skip


def test_a_range_that_does_not_hold_the_rest_is_refused(make_channels):
    with pytest.raises(SatvibError, match=r'sensor_range: 9 m/s\^2 does not hold'):
        make_channels(struts=1, sensor={'rest': 9.80665, 'sensor_range': 9.0})


def test_the_bias_is_learnt_in_one_second_and_then_left_alone(make_channels):
    """Truth: 100 samples of known offset; the mean's error is below 5 standard errors."""
    inputs = make_channels(struts=1).inputs
    sensors, bias = Sensors(inputs, RATE), SensorBias(inputs, RATE)
    rng = np.random.default_rng([4, 0])
    ended = [bias.add(sensors.acceleration(v)) for v in readings(rng, 100, bias=0.1)]
    assert ended == [False] * 99 + [True]
    assert bias.learnt
    error = 5 * 0.005 / 0.050986 / math.sqrt(100)
    assert bias.value == pytest.approx([0.1 / 0.050986] * 2, abs=error)
    assert bias.deviation == pytest.approx([0.005 / 0.050986] * 2, rel=0.4)
    np.testing.assert_array_equal(bias.correct(bias.value), 0.0)


def test_gravity_on_a_vertical_axis_is_bias_too(make_channels):
    inputs = make_channels(struts=1, sensor={'rest': 9.80665}).inputs
    sensors, bias = Sensors(inputs, RATE), SensorBias(inputs, RATE)
    for v in readings(np.random.default_rng([5, 0]), 100, bias=0.5):
        bias.add(sensors.acceleration(v))
    assert bias.value == pytest.approx([9.80665] * 2, abs=0.1)


@pytest.mark.parametrize(
    ('change', 'message'),
    [
        (lambda v: v + np.array([0.0, 0.2]), r'strut_1.lower: rests 0\.\d+ V from .* zero_tolerance'),
        (lambda v: 2.5 + 10.0 * (v - 2.5), 'strut_1.upper: standard deviation .* above noise_limit'),
        (lambda v: np.where(v > 2.5, v, math.nan), 'strut_1.upper: .* samples are no numbers'),
    ],
)  # fmt: skip
def test_an_implausible_bias_is_refused_by_name_and_learnt_anew(make_channels, change, message):
    inputs = make_channels(struts=1).inputs
    sensors, bias = Sensors(inputs, RATE), SensorBias(inputs, RATE)
    rng = np.random.default_rng([6, 0])

    def learn(volts):
        for v in volts:
            bias.add(sensors.acceleration(v))

    with pytest.raises(SatvibError, match=message):
        learn(change(readings(rng, 100)))
    assert not bias.learnt
    assert (bias.value == 0.0).all()
    learn(readings(rng, 100))
    assert bias.learnt


def test_less_than_a_second_is_refused(make_channels):
    with pytest.raises(SatvibError, match='calibration_time'):
        SensorBias(make_channels().inputs, RATE, 0.9)


def test_what_was_learnt_is_stored_by_channel(make_channels, tmp_path):
    inputs = make_channels(struts=1).inputs
    sensors, bias = Sensors(inputs, RATE), SensorBias(inputs, RATE)
    for v in readings(np.random.default_rng([7, 0]), 100):
        bias.add(sensors.acceleration(v))
    save_bias(tmp_path / 'bias.yaml', bias.to_mapping())
    stored = load_yaml(tmp_path / 'bias.yaml')
    assert stored['strut_1.upper']['bias'] == bias.value[0]
    assert list(stored) == ['strut_1.upper', 'strut_1.lower']
    with pytest.raises(SatvibError, match='cannot be written'):
        save_bias(tmp_path / 'none' / 'bias.yaml', {})
