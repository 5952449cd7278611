# SPDX-FileCopyrightText: 2026 The satvib authors
# SPDX-License-Identifier: Apache-2.0
"""The guardian between a scripted back end and a scripted bridge, in one process, on a clock that the test turns.

Truth: the rules of its docstring: once per sample, 0 V in every state but ACTIVE, 0 V after any fault, and at the end.
"""

import math

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from satvib_daq_bridge.back_ends.base import BackEnd, BackEndError, EndOfRecordError, Reading
from satvib_daq_bridge.channels import parse_channels
from satvib_daq_bridge.guardian import link
from satvib_daq_bridge.guardian.guardian import Guardian
from satvib_daq_bridge.guardian.output_guard import OutputGuard
from satvib_daq_bridge.simulated.channels_from_rig import channels_of
from satvib_daq_bridge.states import State
from satvib_plant_sim.rig.rig import load_rig

PERIOD, MAX_AGE = 0.01, 0.03
CHANNELS = parse_channels(channels_of(load_rig('paper_3dof')), 'test')


class Scripted(BackEnd):
    """Remembers what is written; reads what it is given."""

    def __init__(self):
        super().__init__(CHANNELS, PERIOD, MAX_AGE)
        self.writes = []
        self.readings = []
        self.error = None
        self.events = []

    def open(self):
        return 'scripted'

    def start(self, now):  # noqa: ARG002
        self.events.append('start')

    def due(self):
        return 0.0 if self.readings or self.error else math.inf

    def poll(self, now):  # noqa: ARG002
        if self.error:
            raise self.error
        found, self.readings = self.readings, []
        return found

    def write(self, volts, sequence, enable, now):
        self.writes.append((volts.copy(), sequence, enable, now))

    def zero(self):
        self.writes.append((np.zeros(3), -1, False, -1.0))

    def close(self):
        self.events.append('close')


class Stand:
    """A guardian with a hand on everything around it."""

    def __init__(self):
        self.time = 100.0
        self.back_end = Scripted()
        ours, others = link.pair()
        self.bridge = link.Link(others)
        guard = OutputGuard(CHANNELS.outputs, PERIOD, MAX_AGE)
        self.guardian = Guardian(self.back_end, guard, link.Link(ours), lambda: self.time)
        self.guardian.start()
        self.k = -1

    def step(self):
        self.back_end.due = lambda: 0.0  # never wait: the test turns the clock
        self.guardian.step([])

    def sample(self, ahead=PERIOD, fault=''):
        self.time += ahead
        self.k += 1
        self.back_end.readings.append(Reading(self.k, self.time, np.full(6, 2.5), fault=fault))
        self.step()

    def say(self, *messages):
        for message in messages:
            self.bridge.send(message)
        self.step()

    def answer(self, volts, sequence=None, struts=range(3)):
        k = self.k if sequence is None else sequence
        self.say(*[link.pack_command(i, k, volts) for i in struts])

    def activate(self, volts=1.0):
        self.sample()
        self.answer(volts)
        self.say(link.pack_mode(State.ARMED), link.pack_mode(State.ACTIVE))
        self.sample()
        self.answer(volts)

    def heard(self):
        found = []
        while message := self.bridge.receive():
            found.append(message)
        return found

    def faults(self):
        return [link.read_text(m) for m in self.heard() if m[0] == link.ToBridge.FAULT]

    @property
    def last(self):
        return self.back_end.writes[-1]

    def close(self):
        self.bridge.close()
        self.guardian.bridge.close()


@pytest.fixture
def stand():
    made = Stand()
    yield made
    made.close()


def test_a_sample_goes_up_as_it_was_read(stand):
    stand.sample()
    taken = link.read_sample(stand.heard()[-1])
    assert (taken.sequence, taken.time) == (0, stand.time)
    assert taken.volts.tolist() == [2.5] * 6
    assert taken.coil.tolist() == [0.0] * 3


def test_voltages_leave_when_every_strut_has_answered(stand):
    stand.activate()
    stand.sample()
    count = len(stand.back_end.writes)
    stand.answer(1.5, struts=[0, 1])
    assert len(stand.back_end.writes) == count
    stand.answer(1.5, struts=[2])
    volts, sequence, enable, _ = stand.last
    assert len(stand.back_end.writes) == count + 1
    assert (sequence, enable) == (stand.k, True)
    assert volts == pytest.approx([0.75] * 3, abs=0.003)


def test_who_is_late_does_not_hold_up_the_others(stand):
    stand.activate(1.0)
    stand.sample()
    stand.answer(2.0, struts=[0, 1])
    stand.sample()
    volts, sequence, _, _ = stand.last
    assert volts == pytest.approx([1.0, 1.0, 0.5], abs=0.003)
    assert sequence == stand.k - 2, 'as old as its oldest part'
    assert stand.guardian.deadlines_missed == 1


def test_no_second_output_in_one_period(stand):
    stand.activate()
    stand.sample()
    stand.answer(1.0)
    count = len(stand.back_end.writes)
    stand.answer(5.0)
    assert len(stand.back_end.writes) == count


def test_an_answer_to_a_sample_that_never_was_or_to_an_older_one_is_ignored(stand):
    stand.activate(1.0)
    stand.sample()
    stand.answer(3.0, sequence=stand.k + 1)
    stand.answer(3.0, sequence=stand.k - 2)
    stand.answer(1.0)
    assert stand.last[0] == pytest.approx([0.5] * 3, abs=0.003)


def test_a_silent_controller_is_a_fault_in_time(stand):
    """Truth: the last answer was to a sample at t; at t + 30 ms it is stale."""
    stand.activate()
    since = stand.time
    stand.sample()
    stand.answer(1.0, struts=[0, 1])
    stand.sample()
    stand.answer(1.0, struts=[0, 1])
    stand.time = since + MAX_AGE - 1e-4
    stand.step()
    assert not stand.faults()
    stand.time = since + MAX_AGE + 1e-4
    stand.step()
    assert stand.faults() == ['strut_3.coil: stale command (0.0301 s old)']
    assert (stand.last[0] == 0.0).all()


def test_after_a_fault_0_v_until_reset_and_active_again(stand):
    stand.activate()
    stand.sample(fault='the device says so')
    assert stand.faults() == ['the device says so']
    stand.answer(1.0)
    assert (stand.last[0] == 0.0).all()
    stand.say(
        link.pack_mode(State.FAULT), link.pack(link.ToGuardian.RESET), link.pack_mode(State.IDLE)
    )
    stand.sample()
    stand.answer(1.0)
    assert (stand.last[0] == 0.0).all()
    stand.say(link.pack_mode(State.ARMED), link.pack_mode(State.ACTIVE))
    stand.sample()
    stand.answer(1.0)
    assert stand.last[0] == pytest.approx([0.5] * 3, abs=0.003)


def test_leaving_active_is_0_v_at_once(stand):
    stand.activate()
    stand.say(link.pack_mode(State.IDLE))
    volts, _, enable, _ = stand.last
    assert (volts == 0.0).all()
    assert not enable


def test_the_end_of_the_bridge_is_the_end_at_0_v(stand):
    stand.activate()
    stand.bridge.close()
    stand.step()
    assert stand.guardian.over
    stand.guardian.finish()
    assert (stand.last[0] == 0.0).all()
    assert stand.back_end.events == ['start', 'close']


@pytest.mark.parametrize(
    ('error', 'kind'),
    [(BackEndError('gone'), link.ToBridge.FAULT), (EndOfRecordError('over'), link.ToBridge.ENDED)],
)
def test_a_back_end_that_ends_is_told_and_ends_the_guardian(stand, error, kind):
    stand.activate()
    stand.back_end.error = error
    stand.step()
    assert [link.read_text(m) for m in stand.heard() if m[0] == kind] == [str(error)]
    assert stand.guardian.over
    stand.guardian.finish()
    assert (stand.last[0] == 0.0).all()


EVENT = st.one_of(
    st.tuples(st.just('sample'), st.sampled_from([0.0, 0.001, PERIOD, PERIOD, PERIOD, 0.05])),
    st.tuples(st.just('answer'), st.one_of(*[st.floats(-30, 30)] * 6, st.floats())),
    st.tuples(st.just('partial'), st.floats(-30, 30)),
    st.tuples(st.just('mode'), st.sampled_from([*State, State.ACTIVE, State.ACTIVE])),
    st.tuples(st.just('reset'), st.none()),
    st.tuples(st.just('fault'), st.none()),
    st.tuples(st.just('wait'), st.floats(0.0, 0.04)),
)


@settings(max_examples=150, deadline=None)
@given(st.lists(EVENT, max_size=50))
def test_whatever_happens_only_active_drives(events):
    """What is written is 0 V whenever the state is not ACTIVE, and always within the limit."""
    stand = Stand()
    stand.activate()
    for kind, value in events:
        count = len(stand.back_end.writes)
        if kind == 'sample':
            stand.sample(value)
        elif kind == 'answer':
            stand.answer(value)
        elif kind == 'partial':
            stand.answer(value, struts=[1])
        elif kind == 'mode':
            stand.say(link.pack_mode(value))
        elif kind == 'reset':
            stand.say(link.pack(link.ToGuardian.RESET))
        elif kind == 'fault':
            stand.sample(fault='sick')
        else:
            stand.time += value
            stand.step()
        stand.heard()
        for volts, _, enable, _ in stand.back_end.writes[count:]:
            assert np.isfinite(volts).all()
            assert (np.abs(volts) <= 10.0).all()
            if stand.guardian.state is not State.ACTIVE or not enable:
                assert (volts == 0.0).all()
        if stand.guardian.guard.fault or stand.guardian.state is not State.ACTIVE:
            assert (stand.back_end.writes[-1][0] == 0.0).all()
    stand.close()
