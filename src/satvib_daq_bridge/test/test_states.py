# SPDX-FileCopyrightText: 2026 The satvib authors
# SPDX-License-Identifier: Apache-2.0
"""The state machine. Truth: the diagram in its docstring, written out as a table here."""

import pytest
from hypothesis import given
from hypothesis import strategies as st
from satvib_common.errors import SatvibError
from satvib_daq_bridge.states import State, StateMachine

U, I, A, X, F, E = State  # noqa: E741
TABLE = {
    'configure': {U: I},
    'unconfigure': {U: U, I: U, A: U, X: U, F: U, E: U},
    'arm': {I: A},
    'activate': {A: X},
    'stop': {U: U, I: I, A: I, X: I, F: F, E: E},
    'fault': {U: U, I: F, A: F, X: F, F: F, E: E},
    'estop': {U: U, I: E, A: E, X: E, F: E, E: E},
    'reset': {F: I, E: I},
}


@given(st.lists(st.sampled_from(sorted(TABLE)), max_size=60))
def test_no_way_but_those_of_the_table(events):
    """Also: ACTIVE is reached from ARMED alone, a latch ends by reset alone, each change is told with a reason."""
    told = []
    machine = StateMachine(told.append)
    latched = None
    for event in events:
        before = machine.state
        after = TABLE[event].get(before)
        act = getattr(machine, event)
        if after is None:
            with pytest.raises(SatvibError, match=f'{event}: refused in {before.name}'):
                act()
            assert machine.state is before
            continue
        if event == 'configure' and latched:
            after = latched
        act('why') if event in {'fault', 'estop'} else act()
        assert machine.state is after
        if after in {F, E}:
            latched = after
        elif event == 'reset':
            latched = None
        if after is not before:
            assert (told[-1].before, told[-1].after) == (before, after)
            assert told[-1].reason
    assert all(t.before is not t.after for t in told)
    assert all(t.before is A for t in told if t.after is X)
    assert all(t.after in {I, U, E} for t in told if t.before is F)
    assert all(t.after in {I, U} for t in told if t.before is E)


def test_the_first_fault_is_the_one_that_is_reported():
    machine = StateMachine()
    machine.configure()
    machine.fault('first')
    machine.fault('second')
    assert machine.reason == 'first'


def test_a_fault_survives_cleaning_up():
    machine = StateMachine()
    machine.configure()
    machine.estop('button')
    machine.unconfigure()
    machine.configure()
    assert (machine.state, machine.reason) == (State.ESTOP, 'still latched: button')
    machine.reset()
    assert machine.state is State.IDLE
