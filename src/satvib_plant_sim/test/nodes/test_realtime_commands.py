# SPDX-FileCopyrightText: 2026 The satvib authors
# SPDX-License-Identifier: Apache-2.0
"""The voltages at the coils in real time, and the answers in lockstep."""

import numpy as np
import pytest
from satvib_common.errors import RunError, SatvibError
from satvib_plant_sim.nodes.lockstep_answers import Answers
from satvib_plant_sim.nodes.realtime_commands import Commands

PERIOD, TIMEOUT = 0.01, 0.05


def test_a_command_holds_until_the_next():
    """Truth: zero-order hold, by hand; the arrival belongs to its period alone."""
    commands = Commands(2, TIMEOUT, PERIOD)
    commands.take(0, 3.0, now=0.004, since_sample=0.004, late=False)
    voltage, arrival = commands.period_over(0.01)
    assert (voltage.tolist(), arrival.tolist()) == ([3.0, 0.0], [0.004, 0.0])
    voltage, arrival = commands.period_over(0.02)
    assert (voltage.tolist(), arrival.tolist()) == ([3.0, 0.0], [0.0, 0.0])


def test_silence_is_ramped_to_zero_and_latched():
    """Truth: a straight line to 0 V within the timeout's own length, 5 periods; then nothing but reset helps."""
    commands = Commands(1, TIMEOUT, PERIOD)
    commands.take(0, -5.0, now=0.0, since_sample=0.0, late=False)
    seen = [commands.period_over((k + 1) * PERIOD)[0][0] for k in range(14)]
    assert seen[:5] == [-5.0] * 5
    np.testing.assert_allclose(seen[5:10], [-4.0, -3.0, -2.0, -1.0, 0.0], atol=1e-12)
    assert seen[10:] == [0.0] * 4
    assert commands.fault.all()
    commands.take(0, 2.0, now=0.2, since_sample=0.0, late=True)
    assert commands.period_over(0.21)[0][0] == 0.0
    assert commands.late == 1
    commands.reset()
    commands.take(0, 2.0, now=0.22, since_sample=0.0, late=False)
    assert commands.period_over(0.23)[0][0] == 2.0


def test_a_strut_that_was_never_heard_is_not_at_fault():
    """Truth: the design. Nothing was commanded, so nothing is missing."""
    commands = Commands(1, TIMEOUT, PERIOD)
    for k in range(100):
        assert commands.period_over(k * PERIOD)[0][0] == 0.0
    assert not commands.fault.any()


def test_a_voltage_that_is_no_number_latches_its_strut_alone():
    """Truth: the house rule on voltages that are not finite."""
    commands = Commands(2, TIMEOUT, PERIOD)
    commands.take(0, float('nan'), now=0.0, since_sample=0.0, late=False)
    commands.take(1, 1.0, now=0.0, since_sample=0.0, late=False)
    assert commands.period_over(0.01)[0].tolist() == [0.0, 1.0]
    assert commands.fault.tolist() == [True, False]


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
