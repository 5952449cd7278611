# SPDX-FileCopyrightText: 2026 The satvib authors
# SPDX-License-Identifier: Apache-2.0
"""The plant as others use it: batches, seeds, commands and what it refuses."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from numpy.testing import assert_allclose, assert_array_equal
from satvib_common.errors import SatvibError
from satvib_plant_sim.disturbance import make_disturbance
from satvib_plant_sim.plant.plant import Plant
from satvib_plant_sim.rig.rig import load_rig

NONE = make_disturbance(None)
QUIET = {
    'accelerometer.noise_rms': 0.0,
    'accelerometer.zero_tolerance': 0.0,
    'acquisition.input_bits': 0,
    'acquisition.output_bits': 0,
}
FIELDS = ('upper', 'lower', 'stroke', 'stroke_peak', 'force_peak', 'current')


def run(plant, volts, arrivals=None):
    """Everything a plant gives under voltages (samples, *shape, struts), as one dictionary of arrays."""
    found = {f'sample_{name}': [] for name in ('upper', 'lower')} | {name: [] for name in FIELDS}
    for k, v in enumerate(volts):
        sample = plant.sample()
        found['sample_upper'].append(sample.upper)
        found['sample_lower'].append(sample.lower)
        truth = plant.advance(v, None if arrivals is None else arrivals[k])
        for name in FIELDS:
            found[name].append(getattr(truth, name))
    return {name: np.array(items) for name, items in found.items()}


TRIALS = [
    ({}, {'kind': 'sine', 'amplitude': 1.0, 'frequency': 10.0}, 1),
    (
        {'payload.mass': 7.0, 'acquisition.input_delay': 0.0131, 'acquisition.hold': 'linear'},
        {'kind': 'random', 'rms': 1.0, 'low': 2.0, 'high': 50.0},
        7,
    ),
    (
        {'coil.drive': 'current', 'coil.transconductance': 0.3, 'struts.stiffness_scale.1': 0.7},
        {'kind': 'pulse', 'amplitude': 500.0, 'duration': 0.02},
        2**40,
    ),
    ({'shaker.rigid': True, 'acquisition.input_delay': 0.00337}, {'kind': 'none'}, 0),
]


@pytest.mark.parametrize('name', ['paper_3dof', 'clean_3dof'])
def test_a_batch_equals_its_trials_one_by_one(name):
    """Truth: single plants; bit for bit, with stops, both holds, both drives, several delays and disturbances."""
    rigs = [load_rig(name, changes) for changes, _, _ in TRIALS]
    disturbances = [make_disturbance(d) for _, d, _ in TRIALS]
    seeds = [s for _, _, s in TRIALS]
    volts = np.random.default_rng(0).uniform(-20.0, 20.0, (150, 4, 3))
    together = Plant(rigs, disturbances, seeds)
    assert together.shape == (4,)
    whole = run(together, volts)
    assert whole['stroke_peak'].max() > 7.6e-3, 'no stop was touched, so the test proves less'
    for i in range(4):
        alone = Plant(rigs[i], disturbances[i], seeds[i])
        assert alone.shape == ()
        single = run(alone, volts[:, i])
        for key, values in single.items():
            assert_array_equal(whole[key][:, i], values, err_msg=f'{key} of trial {i}')
        assert together.energy()[i] == alone.energy()


def test_same_seed_same_bits_other_seed_other_noise_same_truth():
    """Truth: determinism; exact. The seed moves sensors and random disturbances, not the mechanics."""
    rig = load_rig('paper_3dof')
    tone = make_disturbance({'kind': 'sine', 'amplitude': 1.0, 'frequency': 10.0})
    volts = np.random.default_rng(1).uniform(-5.0, 5.0, (60, 3))
    one, again, other = (run(Plant(rig, tone, s), volts) for s in (4, 4, 5))
    for key in one:
        assert_array_equal(one[key], again[key])
    assert np.all(one['sample_upper'][5] != other['sample_upper'][5])
    assert_array_equal(one['upper'], other['upper'])


def test_single_things_are_shared_by_a_batch():
    """Truth: the spelled-out batch; exact."""
    rig = load_rig('paper_1dof')
    volts = np.ones((20, 3, 1))
    short, spelled = Plant(rig, NONE, [1, 2, 3]), Plant([rig] * 3, [NONE] * 3, [1, 2, 3])
    a, b = run(short, volts), run(spelled, volts)
    for key in a:
        assert_array_equal(a[key], b[key])
    assert Plant([rig], NONE, 1).shape == (1,)


def test_shapes_and_names_are_those_of_the_contract():
    """Truth: docs/architecture.md."""
    plant = Plant(load_rig('paper_3dof'), NONE, [1, 2])
    sample = plant.sample()
    assert (plant.dt, plant.struts, plant.n_fine) == (0.01, 3, 40)
    assert plant.fine_period == pytest.approx(0.25e-3)
    assert sample.sequence == 0
    assert sample.upper.shape == sample.lower.shape == (2, 3)
    truth = plant.advance(np.zeros((2, 3)))
    assert truth.upper.shape == truth.lower.shape == (2, 3, 40)
    for name in ('stroke', 'stroke_peak', 'force_peak', 'current'):
        assert getattr(truth, name).shape == (2, 3)
    assert plant.sample().sequence == 1
    assert plant.energy().shape == (2,)


def test_the_fine_grid_is_at_least_four_kilohertz_at_any_rate():
    """Truth: the design; a whole number of steps per sample."""
    for rate, steps in ((100.0, 40), (130.0, 31), (200.0, 20), (1000.0, 4), (5000.0, 1)):
        changes = {'acquisition.sample_rate': rate}
        plant = Plant(load_rig('clean_3dof', changes), NONE, 1)
        assert plant.n_fine == steps
        assert plant.n_fine / plant.dt >= 4000.0 * (1 - 1e-12)


def test_voltages_reach_the_terminals_limited_and_quantized():
    """Truth: 12 bit over +-10 V times a gain of 2: steps of 9.77 mV; +-20 V less one code at the top."""
    plant = Plant(load_rig('paper_3dof'), NONE, 1)
    step = 20.0 / 4096 * 2
    plant.advance([0.3 * step, 0.6 * step, -1.6 * step])
    assert_allclose(plant.terminal_voltage, [0.0, step, -2 * step], rtol=1e-12)
    plant.advance([100.0, -100.0, 20.0])
    assert_allclose(plant.terminal_voltage, [20.0 - step, -20.0, 20.0 - step], rtol=1e-12)
    exact = Plant(load_rig('paper_3dof', QUIET), NONE, 1)
    exact.advance([100.0, -100.0, 0.123])
    assert_allclose(exact.terminal_voltage, [20.0, -20.0, 0.123], rtol=1e-15)


@pytest.mark.parametrize('hold', ['zero', 'linear'])
def test_a_measured_arrival_equals_the_same_delay_of_the_rig(hold):
    """Truth: the rig with that input_delay; exact on the fine grid, and rounded to it otherwise."""
    tone = make_disturbance({'kind': 'sine', 'amplitude': 1.0, 'frequency': 10.0})
    volts = np.random.default_rng(2).uniform(-5.0, 5.0, (50, 3))
    delay = {'acquisition.input_delay': 0.00225, 'acquisition.hold': hold}
    expected = run(Plant(load_rig('paper_3dof', delay), tone, 1), volts)
    other = {**delay, 'acquisition.input_delay': 0.0}
    for arrival in (0.00225, 0.00234, [0.00225, 0.0022, 0.0023]):
        found = run(Plant(load_rig('paper_3dof', other), tone, 1), volts, [arrival] * 50)
        for key in expected:
            assert_array_equal(found[key], expected[key])


def test_arrivals_differ_from_strut_to_strut():
    """Truth: 5 V / 2.7 ohm less back-EMF some time constants (0.85 ms) after the arrival, nearly nothing before."""
    plant = Plant(load_rig('paper_3dof', QUIET), NONE, 1)
    plant.advance([5.0, 5.0, 5.0], arrival=[0.0, 0.005, 0.01])
    # the last one arrives with the next sample, so nothing of it is seen yet
    current = plant.advance([5.0, 5.0, 5.0], arrival=0.0).current
    assert min(current[0], current[1]) > 1.5
    assert abs(current[2]) < 0.02


@pytest.mark.parametrize('hold', ['zero', 'linear'])
def test_a_voltage_that_does_not_arrive_changes_nothing(hold):
    """Truth: the same voltage again; exact."""
    rig = load_rig('paper_3dof', {**QUIET, 'acquisition.hold': hold})
    one, two = Plant(rig, NONE, 1), Plant(rig, NONE, 1)
    for plant in (one, two):
        plant.advance(np.full(3, 3.0), arrival=0.0)
        plant.advance(np.full(3, 3.0), arrival=0.0)
    for _ in range(5):
        lost, kept = (
            one.advance(np.full(3, -9.0), arrival=np.nan),
            two.advance(np.full(3, 3.0), 0.0),
        )
        assert_array_equal(lost.upper, kept.upper)


@settings(max_examples=40, deadline=None)
@given(
    arrivals=st.lists(st.floats(0.0, 0.01), min_size=12, max_size=12),
    linear=st.booleans(),
    seed=st.integers(0, 1000),
)
def test_jittering_arrivals_follow_the_hold(arrivals, linear, seed):
    """Truth: the current of an ideal current drive, which is the voltage itself, rebuilt line by line.

    An amplifier of 1 MHz follows within 1e-9 A of a 1 V, 10 ms line after a fine step, except in the step of a jump.
    """
    changes = {'coil.drive': 'current', 'coil.transconductance': 1.0, 'coil.bandwidth': 1e6}
    changes['acquisition.hold'] = 'linear' if linear else 'zero'
    plant = Plant(load_rig('paper_1dof', {**QUIET, **changes}), NONE, 1)
    T, h = plant.dt, plant.fine_period
    volts = np.random.default_rng(seed).uniform(-1.0, 1.0, 12)
    arrivals = np.minimum(np.rint(np.array(arrivals) / h), plant.n_fine) * h
    found = [plant.advance([v], a).current[0] for v, a in zip(volts, arrivals, strict=True)]

    # the voltage as a list of lines: from (t0, v0) towards v1 in T
    lines, expected = [(-1.0, 0.0, 0.0)], []

    def at(t):
        t0, v0, v1 = next(line for line in reversed(lines) if line[0] <= t + 1e-12)
        return v0 + (v1 - v0) * min((t - t0) / T, 1.0) if linear else v1

    for k in range(12):
        # at a sample, before what arrives at this very instant
        t0, v0, v1 = next(line for line in reversed(lines) if line[0] < k * T - 1e-12)
        expected.append(v0 + (v1 - v0) * min((k * T - t0) / T, 1.0) if linear else v1)
        t = k * T + arrivals[k]
        lines.append((t, at(t), volts[k]))
    # 1 / (2 pi 1 MHz) is 0.16 us: a line of 2 V in a period lags by 2 V 0.16 us / T
    assert_allclose(found, expected, atol=2.1 * 0.16e-6 / T + 1e-9)


def test_a_latency_of_several_periods_is_a_queue():
    """Truth: the same voltages shifted by three periods; exact."""
    volts = np.random.default_rng(3).uniform(-5.0, 5.0, (40, 3))
    slow = Plant(load_rig('paper_3dof', {**QUIET, 'acquisition.input_delay': 0.03225}), NONE, 1)
    fast = Plant(load_rig('paper_3dof', {**QUIET, 'acquisition.input_delay': 0.00225}), NONE, 1)
    late = np.concatenate([np.zeros((3, 3)), volts[:-3]])
    assert_allclose(run(slow, volts)['upper'], run(fast, late)['upper'], atol=1e-13)


@pytest.mark.parametrize('seconds', [40, pytest.param(600, marks=pytest.mark.long)])
def test_a_long_run_does_not_drift(seconds):
    """Truth: a steady state; the peak of truth in every second after the tenth is the same within 1e-9."""
    tone = make_disturbance({'kind': 'sine', 'amplitude': 1.0, 'frequency': 10.0})
    plant = Plant(load_rig('paper_3dof', QUIET), tone, 1)
    peaks = [
        max(np.abs(plant.advance(np.ones(3)).upper).max() for _ in range(100))
        for _ in range(seconds)
    ]
    assert_allclose(peaks[10:], peaks[10], rtol=1e-9)


def test_what_does_not_fit_is_refused_by_name():
    """Truth: the message names it."""
    rig, one = load_rig('paper_3dof'), load_rig('paper_1dof', {'acquisition.sample_rate': 100.0})
    with pytest.raises(SatvibError, match='2 rigs, 1 disturbances and 3 seeds do not make a batch'):
        Plant([rig, rig], NONE, [1, 2, 3])
    with pytest.raises(SatvibError, match=r'differ in struts.count: 1, 3'):
        Plant([rig, one], NONE, 1)
    with pytest.raises(SatvibError, match=r'differ in acquisition\.filter_order: 1, 2'):
        Plant([rig, load_rig('paper_3dof', {'acquisition.filter_order': 2})], NONE, 1)
    with pytest.raises(SatvibError, match=r'differ in acquisition\.sample_rate: 100.0, 200.0'):
        Plant([rig, load_rig('paper_3dof', {'acquisition.sample_rate': 200.0})], NONE, 1)
    with pytest.raises(SatvibError, match='seed -1 is less than 0'):
        Plant(rig, NONE, [1, -1])
    plant = Plant(rig, NONE, 1)
    plant.advance(np.zeros(3))
    with pytest.raises(SatvibError, match='voltage: nan for strut 2 at sample 1'):
        plant.advance([0.0, np.nan, 0.0])
    with pytest.raises(SatvibError, match=r'voltage: shape .2,., not .3,.'):
        plant.advance([0.0, 0.0])
    assert plant.sequence == 1, 'a refused voltage must not move the plant'
