# SPDX-FileCopyrightText: 2026 The satvib authors
# SPDX-License-Identifier: Apache-2.0
"""What a device does with what reaches it. Truth: the rules of docs/serial_protocol.md, at exact microseconds."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from satvib_daq_bridge.protocol.framing import FrameReader, frame
from satvib_daq_bridge.protocol.messages import (
    Command,
    Configure,
    Configured,
    Flag,
    Hello,
    Hold,
    Identity,
    Refusal,
    Stop,
    Zero,
    pack,
    parse,
)
from satvib_daq_bridge.simulated.device import Device

IDENTITY = Identity(
    0, 0, 1, 6, 3, 12, -5_000_000, 5_000_000, -10_000_000, 10_000_000, 500_000, 'test'
)
LIMIT, LIFETIME = 9_000_000, 20_000
SETUP = Configure(77, 1, 5_000_000, LIFETIME, Hold.ZERO, 6, (LIMIT,) * 3)


def send(device, message, now):
    return [parse(p) for p in FrameReader().feed(device.receive(frame(pack(message)), now))]


def device_in_session(hold=Hold.ZERO, now=0):
    device = Device(IDENTITY)
    (answer,) = send(device, Configure(77, 1, 5_000_000, LIFETIME, hold, 6, (LIMIT,) * 3), now)
    assert answer == Configured(77, 1, Refusal.NONE)
    device.take_sample((0,) * 6, now)
    return device


def command(number, volts=1_000_000, sample=0, enable=True, session=77):
    return Command(session, number, sample, enable, (volts,) * 3)


def sample_of(device, now):
    (payload,) = FrameReader().feed(device.take_sample((1, 2, 3, 4, 5, 6), now))
    return parse(payload)


def test_it_says_what_it_is():
    (answer,) = send(Device(IDENTITY), Hello(0, 42), 0)
    assert (answer.number, answer.inputs, answer.outputs, answer.name) == (42, 6, 3, 'test')


@pytest.mark.parametrize(
    ('change', 'refusal'),
    [
        ({'period': 499_999}, Refusal.PERIOD),
        ({'period': 2_000_000_000}, Refusal.PERIOD),
        ({'lifetime': 0}, Refusal.LIFETIME),
        ({'lifetime': 50_001}, Refusal.LIFETIME),
        ({'inputs': 7}, Refusal.COUNTS),
        ({'limits': (1, 1)}, Refusal.COUNTS),
        ({'limits': (1, -1, 1)}, Refusal.LIMITS),
    ],
)
def test_a_set_up_that_it_cannot_do_is_refused(change, refusal):
    fields = {**SETUP.__dict__, **change}
    device = Device(IDENTITY)
    assert send(device, Configure(**fields), 0) == [Configured(77, 1, refusal)]
    assert device.configured is None


def test_without_a_session_nothing_moves():
    device = Device(IDENTITY)
    send(device, command(1), 0)
    assert (device.targets, device.take_sample((0,) * 6, 0)) == ((0.0,) * 3, b'')


def test_outputs_stand_until_their_lifetime_is_over_and_not_a_microsecond_longer():
    device = device_in_session()
    send(device, command(1), 100)
    device.watch(100 + LIFETIME - 1)
    assert device.targets == (1_000_000.0,) * 3
    assert device.expires() == 100 + LIFETIME
    device.watch(100 + LIFETIME)
    assert device.targets == (0.0,) * 3
    assert sample_of(device, 100 + LIFETIME).flags == Flag.EXPIRED


def test_after_expiry_only_a_command_without_enable_opens_the_way():
    device = device_in_session()
    send(device, command(1), 0)
    device.watch(LIFETIME)
    send(device, command(2), LIFETIME + 1)
    assert device.targets == (0.0,) * 3
    send(device, command(3, enable=False), LIFETIME + 2)
    send(device, command(4), LIFETIME + 3)
    assert device.targets == (1_000_000.0,) * 3


def test_repeated_old_and_foreign_commands_do_nothing():
    device = device_in_session()
    send(device, command(5, 1_000_000), 0)
    for bad in (
        command(5, 2_000_000),
        command(4, 2_000_000),
        command(6, 2_000_000, session=78),
        command(6, 2_000_000, sample=1),
        command(6, 2_000_000, sample=2**32 - 5),
        Command(77, 6, 0, True, (2_000_000,) * 2),
    ):
        send(device, bad, 10)
        assert device.targets == (1_000_000.0,) * 3
    assert device.refused == 6
    send(device, command(9, 3_000_000), 20)
    assert device.targets == (3_000_000.0,) * 3, 'lost numbers in between are no harm'


def test_a_command_that_answers_an_old_sample_does_nothing():
    """Truth: a lifetime of 20 ms is four periods of 5 ms; a burst out of a stalled buffer must not act."""
    device = device_in_session()
    for k in range(1, 10):
        device.take_sample((0,) * 6, 5000 * k)
    send(device, command(1, sample=4), 45_000)
    assert device.targets == (0.0,) * 3
    send(device, command(2, sample=5), 45_000)
    assert device.targets == (1_000_000.0,) * 3


def test_the_limit_of_the_session_holds():
    device = device_in_session()
    send(device, command(1, 2_000_000_000), 0)
    assert device.targets == (float(LIMIT),) * 3


def test_zero_and_stop_work_from_any_session():
    for message in (Zero(3, 4), Stop(3, 4)):
        device = device_in_session()
        send(device, command(1), 0)
        send(device, message, 1)
        assert device.targets == (0.0,) * 3
        send(device, command(2), 2)
        assert device.targets == (0.0,) * 3
    assert device.configured is None


def test_disable_works_whatever_its_number():
    device = device_in_session()
    send(device, command(9), 0)
    send(device, command(3, enable=False), 1)
    assert device.targets == (0.0,) * 3


def test_a_new_session_begins_at_zero():
    device = device_in_session()
    send(device, command(1), 0)
    send(device, Configure(78, 2, 5_000_000, LIFETIME, Hold.ZERO, 6, (LIMIT,) * 3), 10)
    assert device.targets == (0.0,) * 3
    send(device, command(2), 20)
    assert device.targets == (0.0,) * 3
    assert sample_of(device, 5010).number == 0


def test_linear_hold_moves_in_straight_lines_and_stops_at_once():
    """Truth: a line from the value at arrival to the new one over one period of 5 ms."""
    device = device_in_session(Hold.LINEAR)
    send(device, command(1, 1_000_000), 0)
    assert device.outputs(0) == (0.0,) * 3
    assert device.outputs(1250) == (250_000.0,) * 3
    send(device, command(2, 0), 2500)
    assert device.outputs(2500) == (500_000.0,) * 3
    assert device.outputs(5000) == (250_000.0,) * 3
    assert device.outputs(7500) == (0.0,) * 3
    send(device, command(3, 1_000_000), 8000)
    send(device, Zero(), 9000)
    assert device.outputs(9000) == (0.0,) * 3


def test_a_sample_tells_what_was_rejected_and_refused():
    device = device_in_session()
    device.receive(b'rubbish\0', 0)
    send(device, command(1, session=5), 0)
    send(device, command(7), 1)
    device.overrun()
    sample = sample_of(device, 5000)
    assert (sample.number, sample.time, sample.command) == (1, 5000, 7)
    assert (sample.rejected, sample.refused) == (1, 1)
    assert sample.flags == Flag.ENABLED | Flag.OVERRUN
    assert sample.inputs == (1, 2, 3, 4, 5, 6)


EVENT = st.one_of(
    st.tuples(st.just('wait'), st.integers(0, 30_000)),
    st.tuples(st.just('bytes'), st.binary(max_size=40)),
    st.tuples(st.just('flip'), st.integers(0, 2**16)),
    st.tuples(
        st.just('command'),
        st.tuples(st.integers(0, 40), st.integers(-(2**31), 2**31 - 1), st.booleans()),
    ),
)


@settings(max_examples=200, deadline=None)
@given(st.lists(EVENT, max_size=60), st.sampled_from(Hold))
def test_under_any_attack_outputs_are_lawful(events, hold):
    """Never above the limit; at 0 V when no whole command with enable came within the lifetime."""
    device = device_in_session(hold)
    now, heard = 0, None
    for kind, value in events:
        wire = b''
        if kind == 'wait':
            now += value
            for _ in range(value // 5000):
                device.take_sample((0,) * 6, now)
        elif kind == 'bytes':
            wire = value
        else:
            number, volts, enable = value if kind == 'command' else (39, 1_000_000, True)
            wire = frame(pack(command(number, volts, max(device.samples - 1, 0), enable)))
            if kind == 'flip':
                damaged = bytearray(wire)
                damaged[value // 8 % len(wire)] ^= 1 << value % 8
                wire = bytes(damaged)
            else:
                heard = now if enable else heard
        device.receive(wire, now)
        device.watch(now)
        out = np.array(device.outputs(now))
        assert (np.abs(out) <= LIMIT).all()
        if heard is None or now - heard >= LIFETIME:
            assert (out == 0.0).all()
