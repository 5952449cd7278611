# SPDX-FileCopyrightText: 2026 The satvib authors
# SPDX-License-Identifier: Apache-2.0
"""Bridge, guardian and a simulated plant in one process, in lockstep: the whole path of a sample and its voltages.

Truth: the plant alone, driven by the same voltages; the channel path adds only rounding.
"""

import math

import numpy as np
import pytest
from satvib_common.errors import SatvibError
from satvib_daq_bridge.back_ends.factory import make_back_end
from satvib_daq_bridge.bridge.bridge import Bridge
from satvib_daq_bridge.channels import parse_channels
from satvib_daq_bridge.guardian import link
from satvib_daq_bridge.guardian.guardian import Guardian
from satvib_daq_bridge.guardian.output_guard import OutputGuard
from satvib_daq_bridge.parameters import BridgeParameters
from satvib_daq_bridge.simulated.channels_from_rig import channels_of
from satvib_daq_bridge.states import State
from satvib_plant_sim.disturbance import make_disturbance
from satvib_plant_sim.plant.plant import Plant
from satvib_plant_sim.rig.rig import load_rig

DISTURBANCE = {'kind': 'sine', 'frequency': 10.0, 'amplitude': 1.0, 'start': 0.5}
RIG = load_rig('paper_3dof')


class Loop:
    """Both ends of the line, pumped by hand."""

    def __init__(self, end=0, struts=('upper', 'lower'), coil=(), **parameters):
        options = {'rig': 'paper_3dof', 'disturbance': DISTURBANCE, 'seed': 7, 'pace': 'lockstep'}
        data = channels_of(RIG, options=options, coil=dict(coil))
        if 'lower' not in struts:
            data['struts']['strut_2']['lower'] = None
        self.channels = parse_channels(data, 'test')
        given = BridgeParameters(channels='test', sample_rate=100.0, **parameters)
        back_end = make_back_end(self.channels, given.period, given.max_age)
        ours, others = link.pair()
        self.link = link.Link(others)
        guard = OutputGuard(self.channels.outputs, given.period, given.max_age)
        self.guardian = Guardian(back_end, guard, link.Link(ours))
        self.transitions = []
        self.bridge = Bridge(self.channels, given, self.link.send, self.transitions.append)
        self.guardian.start()
        self.bridge.configured(virtual=True, now=0.0)
        self.schedule_end = end

    def pump(self):
        """One turn of both; gives what is to be published."""
        self.guardian.step([])
        found = []
        while message := self.link.receive():
            published = self.bridge.take(message, 0.0)
            if published is not None:
                found.append(published)
        return found

    def until(self, condition, turns=500):
        for _ in range(turns):
            if condition():
                return
            assert not self.pump()
        raise AssertionError('it did not come to pass')

    def begin(self):
        self.until(lambda: self.bridge.bias.learnt)
        self.bridge.arm()
        self.bridge.schedule(self.schedule_end)

    def run(self, samples, law):
        """Drive a run; gives the published samples and the voltages at the coils."""
        got, coils = [], []
        while len(got) < samples:
            for published in self.pump():
                got.append(published)
                volts = law(published)
                for i, v in enumerate(volts):
                    self.bridge.command(i, published.sequence, float(v))
                self.guardian.receive()
                coils.append(self.guardian.guard.coil.copy())
        return got, np.array(coils)

    def close(self):
        self.guardian.bridge.close()
        self.link.close()


def tones(published):
    """Voltages that reach every code and every sign."""
    k = published.sequence
    return [3.0 * math.sin(0.2 * k), -5.0 * math.cos(0.05 * k), 0.01 * k]


def test_the_path_is_that_of_the_plant_alone():
    """Accelerations plus bias equal the plant's readings within 1e-9 m/s^2, sample for sample, for 300 samples."""
    loop = Loop()
    loop.begin()
    assert loop.bridge.states.state is State.ARMED
    got, coils = loop.run(300, tones)
    assert loop.bridge.states.state is State.ACTIVE
    plant = Plant(RIG, make_disturbance(DISTURBANCE), 7)
    bias = loop.bridge.bias.value
    for k, published in enumerate(got):
        sample = plant.sample()
        assert published.sequence == k
        np.testing.assert_allclose(published.upper + bias[:3], sample.upper, rtol=0, atol=1e-9)
        np.testing.assert_allclose(published.lower + bias[3:], sample.lower, rtol=0, atol=1e-9)
        plant.advance(np.array(tones(published)))
        if k > 0:  # sample 0 is answered in ARMED, at 0 V
            np.testing.assert_array_equal(coils[k], plant.terminal_voltage)
    loop.close()


def test_two_runs_are_the_same_bits():
    results = []
    for _ in range(2):
        loop = Loop()
        loop.begin()
        got, coils = loop.run(100, tones)
        results.append((np.array([p.upper for p in got]), coils))
        loop.close()
    np.testing.assert_array_equal(results[0][0], results[1][0])
    np.testing.assert_array_equal(results[0][1], results[1][1])


def test_the_learnt_bias_is_that_of_the_simulated_sensors():
    """Truth: the mean of the plant at rest; five standard errors of 100 samples of 0.098 m/s^2."""
    loop = Loop()
    loop.until(lambda: loop.bridge.bias.learnt)
    resting = Plant(RIG, make_disturbance({'kind': 'none'}), 7)
    drawn = np.concatenate([resting._bias[0][:3], resting._bias[0][3:]])
    np.testing.assert_allclose(loop.bridge.bias.value, drawn, atol=5 * 0.098 / 10)
    loop.close()


def test_the_bias_stays_what_it_is_while_active():
    loop = Loop()
    loop.begin()
    before = loop.bridge.bias.value.copy()
    loop.run(50, tones)
    with pytest.raises(SatvibError, match='calibrate: refused'):
        loop.bridge.calibrate()
    np.testing.assert_array_equal(loop.bridge.bias.value, before)
    loop.close()


def test_arming_wants_a_bias_no_objection_and_idle():
    loop = Loop()
    with pytest.raises(SatvibError, match='bias of the sensors is not learnt'):
        loop.bridge.arm()
    loop.until(lambda: loop.bridge.bias.learnt)
    with pytest.raises(SatvibError, match='arm: refused: a second publisher'):
        loop.bridge.arm('a second publisher on strut_1/voltage')
    loop.bridge.arm()
    with pytest.raises(SatvibError, match='refused in ARMED'):
        loop.bridge.arm()
    loop.close()


def test_nothing_is_published_before_schedule_and_arming():
    loop = Loop()
    loop.until(lambda: loop.bridge.bias.learnt)
    loop.bridge.schedule(0)
    assert [p for _ in range(2) for p in loop.pump()] == []
    loop.bridge.arm()
    got, _ = loop.run(3, tones)
    assert [p.sequence for p in got] == [0, 1, 2]
    loop.close()


def test_without_waiting_for_a_schedule_samples_flow_in_idle_at_0_v():
    loop = Loop(wait_for_schedule=False)
    got, coils = loop.run(20, tones)
    assert got[0].sequence == 0
    assert loop.bridge.states.state is State.IDLE
    assert (coils == 0.0).all()
    loop.bridge.arm()
    _, coils = loop.run(20, tones)
    assert loop.bridge.states.state is State.ACTIVE
    assert coils[2:].any()
    loop.close()


def test_the_end_of_the_plan_is_idle_and_said():
    loop = Loop(end=25)
    loop.begin()
    got, _ = loop.run(25, tones)
    loop.pump()
    assert got[-1].sequence == 24
    assert loop.bridge.states.state is State.IDLE
    assert loop.bridge.over == '25 samples of 3 struts; 0 lost'
    loop.close()


@pytest.mark.parametrize('bad', [math.nan, math.inf, -math.inf])
def test_a_voltage_that_is_no_number_is_a_fault_that_names_it(bad):
    loop = Loop()
    loop.begin()
    loop.run(10, tones)
    loop.bridge.command(1, loop.bridge.published, 1.0)
    loop.pump()
    loop.bridge.command(1, loop.bridge.published, bad)
    assert loop.bridge.states.state is State.FAULT
    assert loop.bridge.states.reason.startswith('strut_2: the voltage of sample 10 is')
    loop.pump()
    assert (loop.guardian.guard.coil == 0.0).all()
    loop.close()


def test_repeated_and_foreign_answers_are_refused():
    loop = Loop()
    loop.begin()
    loop.run(5, tones)
    before = loop.bridge.refused
    for strut, sequence in ((0, 4), (0, 2), (1, 99), (2, 6)):
        loop.bridge.command(strut, sequence, 5.0)
    assert loop.bridge.refused == before + 4
    loop.close()


def test_i2t_reaches_the_state_machine_with_its_strut():
    """Truth: see test_output_guard; here the reason must arrive in FAULT."""
    loop = Loop(coil={'thermal_time': 0.1})
    loop.begin()
    with pytest.raises(AssertionError):
        loop.run(200, lambda _: _fail_when(loop.bridge.states.state is State.FAULT, [20.0, 0, 0]))
    assert loop.bridge.states.reason.startswith('strut_1.coil: I^2 t')
    loop.close()


def _fail_when(over, volts):
    assert not over
    return volts


def test_a_strut_without_a_lower_sensor_reads_nan():
    loop = Loop(struts=('upper',))
    loop.begin()
    got, _ = loop.run(3, tones)
    assert [math.isnan(v) for v in got[0].lower] == [False, True, False]
    loop.close()


def test_a_fault_and_its_reset_in_a_run():
    loop = Loop()
    loop.begin()
    loop.run(10, tones)
    loop.bridge.states.estop('button')
    _, coils = loop.run(5, tones)
    assert (coils == 0.0).all()
    loop.bridge.reset()
    _, coils = loop.run(5, tones)
    assert (coils == 0.0).all(), 'reset leads to IDLE only'
    loop.bridge.arm()
    _, coils = loop.run(5, tones)
    assert coils[-1].any()
    assert [str(t).split(':')[0] for t in loop.transitions[-4:]] == [
        'ACTIVE -> ESTOP', 'ESTOP -> IDLE', 'IDLE -> ARMED', 'ARMED -> ACTIVE',
    ]  # fmt: skip
    loop.close()


def test_a_rate_that_is_not_the_rigs_is_refused():
    data = channels_of(RIG, options={'rig': 'paper_3dof'})
    with pytest.raises(
        SatvibError, match='sample_rate: 200 Hz, but rig paper_3dof samples at 100 Hz'
    ):
        make_back_end(parse_channels(data, 'test'), 1 / 200.0, 0.02)


def test_a_channel_that_the_plant_does_not_have_is_named():
    data = channels_of(RIG)
    data['struts']['strut_3']['coil']['index'] = 3
    with pytest.raises(SatvibError, match='output 3 of plant does not exist'):
        make_back_end(parse_channels(data, 'test'), 0.01, 0.02)
    data = channels_of(RIG)
    data['struts']['strut_2']['coil']['device'] = 'other'
    with pytest.raises(SatvibError, match=r'strut_2\.coil: device other'):
        make_back_end(parse_channels(data, 'test'), 0.01, 0.02)
