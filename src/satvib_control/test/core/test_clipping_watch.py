# SPDX-FileCopyrightText: 2026 The satvib authors
# SPDX-License-Identifier: Apache-2.0
"""A clipped sample is not learnt from; a sensor that clips for long takes the law off.

Truth: the rules of `clipping_watch`, and a sensor model of the test's own, clip(y, +-R).
"""

import numpy as np
import pytest
from numpy.testing import assert_array_equal
from satvib_common.phases import Phase, PhasePlan
from satvib_control.core.centralized import make_core
from satvib_control.core.clipping_watch import STRIKES, ClippingWatch
from satvib_control.core.controller import ControllerCore
from satvib_control.laws.base import BasicLaw
from satvib_control.laws.centralized.parameters import CentralizedParameters

RATE = 100.0
ALWAYS = PhasePlan((Phase.CONTROL,), (0,), 10**6)
RANGE = 10.0


def own_law(settings, **changes):
    return settings(
        **({'sample_rate': RATE, 'law': f'{__name__}:Loud', 'watch_loudness': 1000.0} | changes)
    )


class Loud(BasicLaw):
    """Asks for 1 V always, and counts its resets."""

    resets = 0

    def step(self, x, phase):  # noqa: ARG002 - the interface
        self.seen = x
        return np.ones(self.shape)

    def reset(self, mask=True):
        self.resets = self.resets + np.broadcast_to(mask, self.shape)


def run(core, vibration):
    """Voltages and reasons for an acceleration (samples, *shape) as seen by a sensor of +-RANGE."""
    voltages, reasons = [], []
    for k, y in enumerate(vibration):
        seen = np.clip(y, -RANGE, RANGE)
        clipped = np.abs(y) >= RANGE
        out = core.step(k, ALWAYS, seen, np.zeros(core.shape), None, clipped)
        voltages.append(out.voltage)
        reasons.append(out.reason_text((0,) * len(core.shape)))
    return np.array(voltages), reasons


def sine(seconds, amplitude, frequency=7.0):
    return amplitude * np.sin(2 * np.pi * frequency * np.arange(round(seconds * RATE)) / RATE)


def test_a_shock_is_no_reason_to_stop(settings):
    """Truth: 5 samples of 100 are less than a tenth."""
    y = sine(4.0, 0.5 * RANGE)
    y[200:205] = 3.0 * RANGE
    core = ControllerCore(own_law(settings, switch_on_time=0.0))
    voltages, reasons = run(core, y)
    assert_array_equal(voltages, np.ones(400))
    assert set(reasons) == {''}
    assert core.law.resets == 0


def test_the_law_is_told_which_samples_are_clipped(settings):
    core = ControllerCore(own_law(settings), (2,))
    core.step(0, ALWAYS, np.array([RANGE, 1.0]), np.zeros(2), None, [True, False], [False, True])
    assert_array_equal(core.law.seen.upper_clipped, [True, False])
    assert_array_equal(core.law.seen.lower_clipped, [False, True])


def test_a_disturbance_that_clips_holds_0_v_without_a_fault_and_lets_go(settings):
    """Truth: a sine of twice the range clips two thirds of its samples. It lasts 10 s; the law then goes on."""
    y = np.concatenate([sine(2.0, 0.5 * RANGE), sine(10.0, 2.0 * RANGE), sine(10.0, 0.5 * RANGE)])
    core = ControllerCore(own_law(settings, switch_on_time=0.0))
    voltages, reasons = run(core, y)
    assert_array_equal(voltages[:200], 1.0)
    assert_array_equal(voltages[250:1200], 0.0)
    assert reasons[600] == '0 V: the upper sensor clips, so it cannot tell what the law does'
    assert_array_equal(voltages[-400:], 1.0)
    assert reasons[-1] == ''
    assert core.law.resets == 1


def test_a_law_that_drives_the_sensor_to_its_ends_is_stopped_the_third_time(settings):
    """Truth: the vibration clips while, and only while, the voltage is let through. Three strikes, then for good."""
    core = ControllerCore(own_law(settings, switch_on_time=0.0))
    quiet, loud = sine(40.0, 0.5 * RANGE), sine(40.0, 2.0 * RANGE)
    u, voltages, out = 0.0, [], None
    for k in range(len(quiet)):
        y = loud[k] if u > 0.5 else quiet[k]
        out = core.step(k, ALWAYS, np.clip(y, -RANGE, RANGE), np.array(0.0), None, abs(y) >= RANGE)
        u = float(out.voltage)
        voltages.append(u)
    begins = np.count_nonzero(np.diff((np.array(voltages) > 0.5).astype(int)) == 1)
    assert begins == STRIKES - 1  # it came back twice
    assert bool(out.fault)
    assert out.reason_text() == (
        'fault: the law drove the upper sensor to the ends of its range, three times'
    )
    core.reset()
    assert core.step(len(quiet), ALWAYS, np.array(0.0), np.array(0.0)).voltage > 0.0


def test_the_share_of_one_switches_it_off(settings):
    core = ControllerCore(own_law(settings, switch_on_time=0.0, clipping_limit=1.0))
    voltages, _ = run(core, sine(5.0, 5.0 * RANGE))
    assert_array_equal(voltages, 1.0)


def test_a_strut_of_a_batch_has_the_bits_of_its_single_run():
    rng = np.random.default_rng([6, 0])
    clipped = (
        rng.random((3000, 3)) < np.array([0.0, 0.08, 0.5]) * (np.arange(3000) % 1000 < 500)[:, None]
    )
    together = ClippingWatch(0.1, 0.01, (3,))
    alone = [ClippingWatch(0.1, 0.01) for _ in range(3)]
    for row in clipped:
        found = together.step(row, True)
        for i, watch in enumerate(alone):
            for a, b in zip(found, watch.step(row[i], True), strict=True):
                assert_array_equal(a[i], b)


def test_one_clipping_strut_takes_a_common_law_off():
    """Truth: one law for all struts; what one sensor cannot see, no strut may cause."""
    core = make_core(CentralizedParameters(sample_rate=RATE, watch_loudness=1000.0), (3,))
    rest = sine(3.0, 0.5)
    out = None
    for k, y in enumerate(rest):
        ends = np.array([k > 50, False, False])
        out = core.step(k, ALWAYS, np.full(3, y), np.zeros(3), None, ends)
    assert_array_equal(out.voltage, 0.0)
    assert {out.reason_text((i,)) for i in range(3)} == {
        '0 V: the upper sensor clips, so it cannot tell what the law does'
    }


PHASES = (Phase.CALIBRATE, Phase.IDENTIFY, Phase.ADAPT, Phase.CONTROL)
PLAN = PhasePlan(PHASES, (0, 20, 21, 400), 10**6)


@pytest.mark.parametrize('law', ['feedforward', 'model_reference'])
def test_no_gain_moves_on_a_clipped_sample(make_isolator, make_loop, settings, law):
    """Truth: `adapting` is false on every clipped sample, and true on some of the others."""
    model = make_isolator(RATE)
    p = settings(
        sample_rate=RATE, law=law, clipping_limit=1.0, adapt_in_control=True, feedforward_taps=8
    )
    loop = make_loop(p, model, PLAN, identified=model)
    learnt = []
    for k in range(1200):
        d = 4.0 * np.sin(2 * np.pi * 7.0 * k / RATE) * (k > 20)
        at_end = k % 41 == 40
        learnt.append((at_end, bool(loop.step(d, d, (at_end, at_end))[1].state.adapting)))
    assert not any(adapting for at_end, adapting in learnt if at_end)
    assert any(adapting for _, adapting in learnt)


def test_narrowband_goes_through_a_clipped_sample(make_isolator, make_loop, settings):
    """Truth: the voltage does not depend on what a marked sample says; not marked, it does."""
    model = make_isolator(RATE)
    p = settings(sample_rate=RATE, law='narrowband', clipping_limit=1.0, watch_loudness=1000.0)

    def voltages(marked, extra):
        loop = make_loop(p, model, PLAN, identified=model)
        found = []
        for k in range(800):
            at_end = k % 41 == 40
            d = 4.0 * np.sin(2 * np.pi * 7.0 * k / RATE) * (k > 20) + extra * at_end
            found.append(float(loop.step(d, 0.0, (at_end and marked, False))[1].voltage))
        return np.array(found)

    right = voltages(True, 0.0)
    assert np.abs(right).max() > 1.0
    assert_array_equal(voltages(True, 20.0), right)
    assert np.abs(voltages(False, 20.0) - right).max() > 1.0
