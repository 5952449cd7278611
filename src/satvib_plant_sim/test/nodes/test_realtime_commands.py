# SPDX-FileCopyrightText: 2026 The satvib authors
# SPDX-License-Identifier: Apache-2.0
"""The voltages at the coils in real time, and the answers in lockstep."""

import numpy as np
import pytest
from satvib_common.errors import RunError, SatvibError
from satvib_common.struts.applied import Applied
from satvib_plant_sim.nodes.lockstep_answers import Answers
from satvib_plant_sim.nodes.realtime_commands import RIVALS, Commands

PERIOD, TIMEOUT, RETURN = 0.01, 0.05, 0.1
ONE, TWO = ['strut_1'], ['strut_1', 'strut_2']


def make(names, resume=True):
    return Commands(names, TIMEOUT, PERIOD, resume, RETURN)


class Clock:
    """Samples of one strut, period by period, each answered or not."""

    def __init__(self, commands):
        self.commands, self.k = commands, 0

    def period(self, voltage=None, old=0):
        """One period: the voltage answers the sample `old` periods before; gives what the coil had."""
        at = self.k * PERIOD
        if voltage is not None:
            self.commands.take(0, self.k - old, voltage, at + 0.004, 0.004, self.k)
        self.k += 1
        return self.commands.period_over(self.k * PERIOD)[0][0]

    def state(self):
        return Applied(int(self.commands.state[0]))


def test_a_command_holds_until_the_next():
    """Truth: zero-order hold, by hand; the arrival belongs to its period alone."""
    commands = make(TWO)
    commands.take(0, 0, 3.0, 0.004, 0.004, 0)
    voltage, arrival = commands.period_over(0.01)
    assert (voltage.tolist(), arrival.tolist()) == ([3.0, 0.0], [0.004, 0.0])
    assert commands.state.tolist() == [Applied.APPLIED, Applied.WAITING]
    voltage, arrival = commands.period_over(0.02)
    assert (voltage.tolist(), arrival.tolist()) == ([3.0, 0.0], [0.0, 0.0])


@pytest.mark.parametrize('lag', [0.0, 0.5])
def test_a_plant_that_is_behind_its_clock_finds_a_silence_in_the_same_sample(lag):
    """Truth: the time-out in samples, by hand; and samples that are made up for within 1 ms make no silence."""
    commands = make(ONE)
    commands.take(0, 0, 3.0, 0.004 + lag, 0.004, 0, 0.004)
    seen = [
        float(commands.period_over((k + 1) * PERIOD, (k + 1) * PERIOD + lag)[0][0])
        for k in range(8)
    ]
    assert seen == [3.0] * 5 + [0.0] * 3
    commands = make(ONE)
    commands.take(0, 0, 3.0, 1.004, 0.004, 0, 0.004)
    made_up_for = [float(commands.period_over((k + 1) * PERIOD, 1.005)[0][0]) for k in range(80)]
    assert made_up_for == [3.0] * 80


def test_silence_is_0_v_at_once_and_ends_by_itself():
    """Truth: the design. 0 V after 50 ms; then tenths of the voltage, 0.1 s long; the console hears of both."""
    commands = make(ONE)
    clock = Clock(commands)
    seen = [clock.period(-5.0), *(clock.period() for _ in range(9))]
    assert seen == [-5.0] * 5 + [0.0] * 5
    assert clock.state() is Applied.SILENT
    assert '0 V: no fresh voltage for 50 ms' in commands.complaint()
    back = [clock.period(2.0) for _ in range(12)]
    np.testing.assert_allclose(back, [*np.arange(0.2, 2.0, 0.2), 2.0, 2.0, 2.0], rtol=1e-12)
    assert clock.state() is Applied.APPLIED
    assert not commands.complaint()
    fell, rose = commands.events
    assert 'strut_1: 0 V: no fresh voltage' in fell
    assert 'applied again' in rose


def test_silence_can_be_latched():
    """Truth: the design. With `latch` nothing but reset helps, and the complaint names it."""
    commands = make(ONE, resume=False)
    clock = Clock(commands)
    clock.period(-5.0)
    assert [clock.period() for _ in range(6)][-1] == 0.0
    assert [clock.period(2.0) for _ in range(20)] == [0.0] * 20
    assert clock.state() is Applied.LATCHED
    assert 'call ~/reset' in commands.complaint()
    commands.reset()
    assert clock.period() == 0.0
    assert 0.0 < clock.period(2.0) < 2.0
    assert [clock.period(2.0) for _ in range(10)][-1] == 2.0


def test_a_voltage_for_a_sample_long_ago_is_not_fresh():
    """Truth: the design. After a stall the answers to old samples come in one burst: none of them reaches the coil."""
    commands = make(ONE)
    clock = Clock(commands)
    clock.period(1.0)
    for _ in range(30):
        clock.period()
    for k in range(1, 25):
        commands.take(0, k, 9.0, clock.k * PERIOD, 0.0, clock.k)
    assert commands.stale == 24
    assert clock.period() == 0.0
    assert clock.state() is Applied.SILENT


def test_two_controllers_are_a_fault():
    """Truth: one controller answers a sample once. What is repeated latches 0 V, and the reason is named."""
    commands = make(ONE)
    clock = Clock(commands)
    for _ in range(40):
        commands.take(0, clock.k, 1.0, clock.k * PERIOD, 0.0, clock.k)
        clock.period(-1.0)
    assert commands.fault.all()
    assert RIVALS in commands.complaint()


def test_a_controller_that_comes_to_rest_may_say_0_v_again():
    """Truth: what a controller says when it is deactivated: 0 V, for the sample that it has answered."""
    commands = make(ONE)
    clock = Clock(commands)
    commands.take(0, 0, 3.0, 0.0, 0.0, 0)
    assert clock.period(0.0) == 0.0


def test_a_strut_that_was_never_heard_is_not_at_fault():
    """Truth: the design. Nothing was commanded, so nothing is missing; the state says that nothing came."""
    commands = make(ONE, resume=False)
    for k in range(100):
        assert commands.period_over(k * PERIOD)[0][0] == 0.0
    assert not commands.fault.any()
    assert commands.state.tolist() == [Applied.WAITING]


def test_a_voltage_that_is_no_number_latches_its_strut_alone():
    """Truth: the house rule on voltages that are not finite."""
    commands = make(TWO)
    commands.take(0, 0, float('nan'), 0.0, 0.0, 0)
    commands.take(1, 0, 1.0, 0.0, 0.0, 0)
    assert commands.period_over(0.01)[0].tolist() == [0.0, 1.0]
    assert commands.fault.tolist() == [True, False]


@pytest.mark.parametrize('far', [1, 10**9, 2**64 - 1])
def test_an_answer_to_a_sample_that_is_not_there_changes_nothing(far):
    """Truth: a strut that never got it. One such number must not make the plant deaf for the answers that follow."""
    seen = []
    for disturbed in (False, True):
        clock = Clock(make(ONE))
        for k in range(30):
            if disturbed and k == 5:
                clock.commands.take(0, k + far, 9.0, 0.05, 0.0, k)
            seen.append(clock.period(1.0))
        assert not clock.commands.fault.any()
    assert seen[:30] == seen[30:]


def test_a_voltage_beyond_the_amplifier_is_limited_and_said():
    """Truth: by hand."""
    clock = Clock(Commands(ONE, 0.05, PERIOD, limit=20.0))
    clock.period(1.0)
    found = [(clock.period(v), clock.state()) for v in (20.0, 1e300, -21.0, 3.0)]
    limited, applied = Applied.LIMITED, Applied.APPLIED
    assert found == [(20.0, applied), (20.0, limited), (-20.0, limited), (3.0, applied)]


def test_reset_of_one_strut_is_not_felt_by_another():
    """Truth: the other strut's voltage, which is held."""
    commands = make(TWO)
    commands.take(0, 0, float('nan'), 0.0, 0.0, 0)
    commands.take(1, 0, 1.0, 0.0, 0.0, 0)
    commands.period_over(0.01)
    commands.reset()
    assert commands.period_over(0.02)[0].tolist() == [0.0, 1.0]
    assert commands.state.tolist() == [Applied.WAITING, Applied.APPLIED]


def test_lockstep_passes_voltages_on_unless_stopped():
    """Truth: the design. The very bits; 0 V when stopped; a rise after reset."""
    commands = make(TWO)
    asked = np.array([0.1, -7.3])
    assert commands.pass_on(asked).tolist() == asked.tolist()
    assert commands.state.tolist() == [Applied.APPLIED] * 2
    commands.stop()
    assert commands.pass_on(asked).tolist() == [0.0, 0.0]
    assert commands.state.tolist() == [Applied.LATCHED] * 2
    commands.reset()
    risen = [commands.pass_on(asked).tolist() for _ in range(11)]
    np.testing.assert_allclose(risen[0], 0.1 * asked, rtol=1e-12)
    assert risen[-1] == asked.tolist()


def test_lockstep_collects_one_answer_per_strut():
    """Truth: by hand. Repeats and answers to the past are passed over."""
    answers = Answers(['strut_1', 'strut_2'])
    assert not answers.take(0, 0, 1.0, 0)
    assert not answers.take(0, 0, 9.0, 0)
    assert answers.missing(0) == ['strut_2']
    assert answers.take(1, 0, 2.0, 0)
    assert answers.voltage.tolist() == [1.0, 2.0]
    assert not answers.take(1, 0, 5.0, 1)
    assert answers.missing(1) == ['strut_1', 'strut_2']


def test_lockstep_names_what_is_wrong():
    """Truth: the issue's bar: strut and sequence are named."""
    answers = Answers(['strut_1', 'strut_2'])
    with pytest.raises(SatvibError, match=r'strut_2: the voltage of sample 4 is inf'):
        answers.take(1, 4, float('inf'), 4)
    with pytest.raises(RunError, match=r'strut_1: a voltage for sample 5 before'):
        answers.take(0, 5, 0.0, 4)
