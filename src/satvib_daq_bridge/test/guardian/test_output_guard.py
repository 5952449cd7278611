# SPDX-FileCopyrightText: 2026 The satvib authors
# SPDX-License-Identifier: Apache-2.0
"""The output guard. Truth: the rules stated in its docstring, recomputed here channel by channel."""

import math

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from satvib_daq_bridge.channels import CoilChannel
from satvib_daq_bridge.guardian.output_guard import OutputGuard
from satvib_daq_bridge.states import State

PERIOD, MAX_AGE = 0.01, 0.03
ANY = st.floats(allow_nan=True, allow_infinity=True)
GOOD = st.floats(-30.0, 30.0)
LIKELY = st.one_of(*[GOOD] * 12, ANY)
AGE = st.one_of(*[st.floats(0.0, MAX_AGE)] * 12, ANY)
CALL = st.tuples(
    st.tuples(LIKELY, LIKELY),
    st.tuples(AGE, AGE),
    st.sampled_from([*State, *[State.ACTIVE] * 25]),
    st.one_of(st.floats(0.005, 0.02), st.floats(-0.01, 0.05)),
    st.integers(0, 5),
)


def guard_of(max_age=MAX_AGE, **coil):
    fields = {
        'device': 'board', 'polarity': 1, 'range': (-10.0, 10.0), 'bits': 12, 'gain': 2.0,
        'limit': 20.0, 'slew': 20000.0, 'force_constant': 9.8, 'continuous_force': 28.0,
        'resistance': 2.7, 'inductance': 2.3e-3, **coil,
    }  # fmt: skip
    coils = [(f'strut_{i + 1}.coil', CoilChannel(index=i, **fields)) for i in range(2)]
    return OutputGuard(coils, PERIOD, max_age)


SEQUENCES = given(
    st.lists(CALL, min_size=20, max_size=60),
    st.sampled_from([0, 8, 12, 16]),
    st.sampled_from([1, -1]),
    st.floats(50.0, 5e4),
    st.floats(0.5, 20.0),
)


def check_lawful(calls, bits, polarity, slew, limit):
    """Any sequence of commands, NaN, ages, states, intervals and resets: never above the limit, never faster than the
    slew limit except to 0 V, 0 V outside ACTIVE and while at fault, and always on a code that the converter has."""
    guard = guard_of(bits=bits, polarity=polarity, slew=slew, limit=limit, thermal_time=0.05)
    before, step, ratio = np.zeros(2), 20.0 / 2**bits if bits else 0.0, polarity / 2.0
    for demand, age, state, elapsed, resets in calls:
        if resets == 0:
            guard.reset()
        out = guard.apply(np.array(demand), np.array(age), state, elapsed)
        assert np.isfinite(out.coil).all()
        assert (np.abs(out.coil) <= limit * (1 + 1e-9)).all()
        allowed = slew * min(max(elapsed, 0.0), PERIOD) * (1 + 1e-9) + 1e-12
        to_zero = (out.coil == 0.0).all()
        assert to_zero or (np.abs(out.coil - before) <= allowed).all()
        np.testing.assert_allclose(out.converter, out.coil * ratio, rtol=1e-12, atol=1e-15)
        assert (np.abs(out.converter) <= 10.0).all()
        if step:
            codes = out.converter / step
            np.testing.assert_allclose(codes, np.rint(codes), atol=1e-6)
            assert (codes <= 2 ** (bits - 1) - 1 + 1e-6).all()
        bad = not np.isfinite(demand).all() or not all(a <= MAX_AGE for a in age)
        if state is not State.ACTIVE or out.fault or bad:
            assert (out.coil == 0.0).all()
        assert bool(out.fault) or state is not State.ACTIVE or not bad
        before = out.coil


def lawful(examples):
    """The property below, so many times."""
    return settings(max_examples=examples, deadline=None)(SEQUENCES(check_lawful))


test_whatever_comes_the_terminals_stay_lawful = lawful(60)
test_whatever_comes_the_terminals_stay_lawful_long = pytest.mark.long(lawful(3000))


def test_a_fault_latches_and_names_its_channel():
    """A fault of one channel is 0 V at all, whatever is asked next, until reset."""
    guard = guard_of()
    good, fresh = np.array([1.0, 2.0]), np.zeros(2)
    assert guard.apply(good, fresh, State.ACTIVE).coil == pytest.approx(good, abs=0.005)
    for demand, age, said in (
        ([1.0, math.nan], [0.0, 0.0], r'strut_2.coil: the command is no number'),
        ([1.0, 1.0], [0.031, 0.0], 'strut_1.coil: stale command (0.031 s old)'),
        ([1.0, 1.0], [0.0, math.nan], 'strut_2.coil: stale command'),
    ):
        assert guard.apply(np.array(demand), np.array(age), State.ACTIVE).fault.startswith(said)
        after = guard.apply(good, fresh, State.ACTIVE)
        assert after.fault.startswith(said)
        assert (after.coil == 0.0).all()
        guard.reset()
        assert (guard.apply(good, fresh, State.ACTIVE).coil > 0.0).all()


def test_the_converter_rounds_to_the_nearest_code():
    """Truth: +-10 V in 12 bit is 4.8828125 mV; 1 V at the coil is 102.4 codes behind a gain of 2, so 102."""
    out = guard_of().apply(np.array([1.0, -1.0]), np.zeros(2), State.ACTIVE)
    assert out.converter.tolist() == [102 * 0.0048828125, -102 * 0.0048828125]
    assert out.coil.tolist() == [204 * 0.0048828125, -204 * 0.0048828125]
    assert not out.saturated.any()


def test_the_uppermost_code_is_one_step_below_the_range():
    """Truth: two's complement, +2047 and -2048 codes of 4.8828125 mV."""
    out = guard_of(slew=1e9).apply(np.array([20.0, -20.0]), np.zeros(2), State.ACTIVE)
    assert out.converter.tolist() == [2047 * 0.0048828125, -10.0]


def test_slew_and_limit_are_told_as_saturation():
    guard = guard_of(slew=100.0, limit=1.5)
    out = guard.apply(np.array([5.0, 0.5]), np.zeros(2), State.ACTIVE)
    assert out.coil == pytest.approx([1.0, 0.5], abs=0.01)
    assert out.saturated.tolist() == [True, False]
    out = guard.apply(np.array([5.0, 0.5]), np.zeros(2), State.ACTIVE)
    assert out.coil == pytest.approx([1.5, 0.5], abs=0.01)


def test_i2t_trips_when_the_closed_form_says():
    """Truth: a current i from rest reaches the rating after tau ln(1 / (1 - (i_c / i)^2)); 20 V drive 7.4 A through
    2.7 ohm, the rating is 28 N / 9.8 N/A = 2.857 A. Tolerance two periods, for the rise of the current."""
    guard = guard_of(slew=1e6, inductance=0.0, bits=0)
    expected = 10.0 * math.log(1.0 / (1.0 - (28.0 / 9.8 / (20.0 / 2.7)) ** 2))
    calls = 0
    while not guard.fault:
        guard.apply(np.array([20.0, 0.0]), np.zeros(2), State.ACTIVE)
        calls += 1
    assert guard.fault.startswith('strut_1.coil: I^2 t')
    assert calls * PERIOD == pytest.approx(expected, abs=2 * PERIOD)
    warm = guard.load[0]
    for _ in range(1000):
        guard.apply(np.zeros(2), np.zeros(2), State.FAULT)
    assert guard.load[0] == pytest.approx(warm * math.exp(-1.0), rel=1e-6)


def test_the_continuous_rating_may_last():
    """Truth: at the rating the load tends to 1 from below."""
    guard = guard_of(inductance=0.0, bits=0)
    for _ in range(20000):
        out = guard.apply(np.full(2, 28.0 / 9.8 * 2.7 * 0.999), np.zeros(2), State.ACTIVE)
    assert not out.fault
    assert 0.99 < guard.load[0] < 1.0


def test_an_amplifier_that_drives_current_is_counted_in_amperes():
    """Truth: 1 A/V at 3 V is 3 A, above the 2.857 A of the rating; 2.8 A is not."""
    for volts, trips in ((3.0, True), (2.8, False)):
        guard = guard_of(transconductance=1.0, bits=0)
        for _ in range(5000):
            out = guard.apply(np.full(2, volts), np.zeros(2), State.ACTIVE)
        assert bool(out.fault) is trips
