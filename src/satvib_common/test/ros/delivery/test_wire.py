# SPDX-FileCopyrightText: 2026 The satvib authors
# SPDX-License-Identifier: Apache-2.0
"""Messages as bytes, without rclpy's conversion."""

import numpy as np
import pytest

pytest.importorskip('rclpy')
messages = pytest.importorskip('satvib_msgs.msg', exc_type=ImportError)

# the message generator that comes with ROS uses modules that Python 3.11 deprecates
pytestmark = pytest.mark.filterwarnings("ignore:module 'sre_:DeprecationWarning")
KINDS = ['StrutAcceleration', 'VcaVoltage', 'ControllerState', 'StrutProgress']
LIMITS = {'uint8': 2**8, 'uint16': 2**16, 'uint32': 2**32, 'uint64': 2**64 - 1}


def filled(kind, rng):
    """A message with every field drawn; texts of all lengths, so that every padding occurs."""
    message = kind()
    for name, what in kind.get_fields_and_field_types().items():
        if what == 'double':
            setattr(message, name, float(rng.choice([rng.normal(), np.nan, np.inf, -0.0])))
        elif what == 'boolean':
            setattr(message, name, bool(rng.integers(2)))
        elif what == 'string':
            setattr(message, name, 'a°' * int(rng.integers(9)))
        elif what != 'std_msgs/Header':
            setattr(message, name, int(rng.integers(LIMITS[what], dtype=np.uint64)))
    message.header.stamp.sec = int(rng.integers(-(2**31), 2**31))
    message.header.stamp.nanosec = int(rng.integers(2**32))
    message.header.frame_id = 's' * int(rng.integers(12))
    return message


@pytest.mark.parametrize('name', KINDS)
def test_the_bytes_are_those_of_the_middleware(name):
    """Truth: rclpy's own serialization, each way. Its padding is whatever was in memory, so fields are compared."""
    from rclpy.serialization import deserialize_message, serialize_message
    from satvib_common.ros.delivery.wire import wire_of

    kind, rng = getattr(messages, name), np.random.default_rng(7)
    wire = wire_of(kind)
    assert wire is not None
    for _ in range(200):
        message = filled(kind, rng)
        data = serialize_message(message)
        ours = wire.pack(message)
        assert len(ours) == len(data)
        assert repr(deserialize_message(ours, kind)) == repr(message)
        record = wire.unpack(data)
        assert wire.pack(record) == ours
        assert record.header.frame_id == message.header.frame_id
        assert record.header.stamp.sec == message.header.stamp.sec
        assert record.sequence == message.sequence


def test_messages_without_a_header():
    """Truth: rclpy's own serialization, each way."""
    from rclpy.serialization import deserialize_message, serialize_message
    from satvib_common.ros.delivery.wire import wire_of
    from std_msgs.msg import String, UInt64

    for message in (UInt64(data=2**63), String(data='text')):
        wire = wire_of(type(message))
        assert wire is not None
        assert deserialize_message(wire.pack(message), type(message)) == message
        assert wire.unpack(serialize_message(message)).data == message.data


def test_a_big_endian_message_is_read():
    """Truth: the fields, set by hand; bytes written by `struct` after the standard."""
    import struct

    from satvib_common.ros.delivery.wire import wire_of

    data = struct.pack('>4siiI1s3xQd??', b'\0\0\0\0', 3, 4, 1, b'\0', 5, 0.5, True, False)
    record = wire_of(messages.VcaVoltage).unpack(data)
    assert (record.header.stamp.sec, record.sequence, record.voltage) == (3, 5, 0.5)
    assert record.saturated
    assert not record.fault


def test_bytes_that_are_no_message_are_refused():
    """Truth: every beginning of a message that lacks its last field, and texts that are none, by hand.

    A message that is longer is of a later version, which appends fields.
    """
    from satvib_common.ros.delivery.wire import UnreadableError, wire_of

    rng = np.random.default_rng(11)
    for name in KINDS:
        kind = getattr(messages, name)
        wire, message = wire_of(kind), filled(kind, rng)
        message.header.frame_id = 'strut_1'
        data = wire.pack(message)
        for length in range(len(data)):
            with pytest.raises(UnreadableError, match=f'{length} bytes that are no {name}'):
                wire.unpack(data[:length])
        later = data + b'of a later version'
        assert wire.unpack(later).sequence == message.sequence
        wire.check(data)
        with pytest.raises(UnreadableError, match=f'{len(data)} would be'):
            wire.check(later)
        for text in (b'\xff\xff\xff\xff', b'\0\0\0\0'):
            with pytest.raises(UnreadableError, match='a text of'):
                wire.unpack(data[:12] + text + data[16:])
        with pytest.raises(UnreadableError, match='decode'):
            wire.unpack(data[:16] + b'\xff' + data[17:])


def test_texts_of_many_lengths_take_no_memory():
    """A text of each length would leave a layout behind.

    Truth: the lengths that a long run has are few; a stranger may send any.
    """
    from satvib_common.ros.delivery.wire import wire_of

    wire, message = wire_of(messages.ControllerState), messages.ControllerState()
    for length in range(2000):
        message.header.frame_id = 's' * length
        message.reason = 'n' * (length // 2)
        record = wire.unpack(wire.pack(message))
        assert (record.header.frame_id, record.reason) == (message.header.frame_id, message.reason)
    assert len(wire._layouts) <= 256


def test_messages_with_lists_are_checked():
    """Truth: rclpy's own serialization; each beginning and each longer message is refused."""
    from rclpy.serialization import serialize_message
    from satvib_common.ros.delivery.wire import UnreadableError, checker_of

    check = checker_of(messages.IirParameters)
    data = serialize_message(messages.IirParameters(a=[1.0, 2.0], covariance=[0.0] * 4, reason='x'))
    check(data)
    assert data.count(b'\x02\0\0\0x\0') == 1
    wrong_text = data.replace(b'\x02\0\0\0x\0', b'\x02\0\0\0\xff\0')
    cut = [data[:length] for length in range(0, len(data) - 8, 4)]
    for wrong in (*cut, data + bytes(8), wrong_text):
        with pytest.raises(UnreadableError, match='bytes that are no IirParameters'):
            check(wrong)


@pytest.mark.parametrize('name', [*KINDS, 'IirParameters'])
def test_a_text_ends_with_its_zero(name):
    """rosbags stops at a text that does not, and gives nothing of the bag that follows it.

    Truth: CDR; 'strut_1' and its zero are the bytes 16 to 23.
    """
    from rclpy.serialization import serialize_message
    from satvib_common.ros.delivery.wire import UnreadableError, checker_of

    message = getattr(messages, name)()
    message.header.frame_id = 'strut_1'
    data = serialize_message(message)
    check = checker_of(type(message))
    check(data)
    assert data[16:24] == b'strut_1\0'
    with pytest.raises(UnreadableError, match='end with its zero'):
        check(data[:23] + b'\x08' + data[24:])


@pytest.mark.parametrize('updates', [0, 1, 256, 257, 2**40])
def test_an_empty_text_ends_with_its_zero(updates):
    """The bytes of an empty text may stand among the numbers before it, too.

    Truth: CDR: the place of the text is that where the bytes of a longer one differ first.
    """
    from rclpy.serialization import serialize_message
    from satvib_common.ros.delivery.wire import UnreadableError, checker_of

    message = messages.IirParameters(a=[1.0], updates=updates, converged=True)
    data, longer = serialize_message(message), serialize_message(_with(message, reason='x'))
    place = next(i for i in range(len(data)) if data[i] != longer[i])
    check = checker_of(messages.IirParameters)
    check(data)
    with pytest.raises(UnreadableError, match='end with its zero'):
        check(data[: place + 4] + b'\x01' + data[place + 5 :])


def _with(message, **fields):
    """A copy with other fields."""
    copy = type(message)()
    for name in message.get_fields_and_field_types():
        setattr(copy, name, fields.get(name, getattr(message, name)))
    return copy


def test_a_text_of_a_big_endian_message_ends_with_its_zero():
    """Truth: bytes written by `struct` after the standard."""
    import struct

    from satvib_common.ros.delivery.wire import UnreadableError, checker_of
    from std_msgs.msg import Header

    def data(text):
        return struct.pack('>4siII8s', b'\0\0\0\0', 3, 4, 8, text)

    checker_of(Header)(data(b'strut_1\0'))
    with pytest.raises(UnreadableError, match='end with its zero'):
        checker_of(Header)(data(b'strut_1\x08'))


@pytest.mark.parametrize('reason', ['x', 'x\ufffd'])
def test_what_is_in_the_padding_is_no_text(reason):
    """The middleware leaves in the padding what was in its memory, also the bytes of the sign for what is no text.

    Truth: CDR; the four bytes after 'strut_1' and its zero fill up to the sequence number.
    """
    from rclpy.serialization import serialize_message
    from satvib_common.ros.delivery.wire import checker_of

    message = messages.IirParameters(a=[1.0], reason=reason)
    message.header.frame_id = 'strut_1'
    data = serialize_message(message)
    assert data[16:24] == b'strut_1\0'
    checker_of(messages.IirParameters)(data[:24] + '\ufffd'.encode() + data[27:])


def test_what_holds_lists_has_no_wire():
    """Truth: the definitions of the messages."""
    from satvib_common.ros.delivery.wire import wire_of

    assert wire_of(messages.IirParameters) is None
    assert wire_of(messages.Schedule) is None
