# SPDX-FileCopyrightText: 2026 The satvib authors
# SPDX-License-Identifier: Apache-2.0
"""Places of texts in the bytes of a message. Truth: what the texts are."""

import pytest

messages = pytest.importorskip('satvib_msgs.msg')


def examples():
    from diagnostic_msgs.msg import DiagnosticArray, DiagnosticStatus, KeyValue

    pairs = [KeyValue(key=f'key {i}', value='x' * i) for i in range(5)]
    status = [DiagnosticStatus(name='a', message='bc', values=pairs[:n]) for n in (0, 5, 2)]
    return [
        messages.Schedule(scenario='soft', struts=['strut_1', 'strut_22', ''], phases=[0, 1], first_sequence=[0, 5]),
        messages.Schedule(),
        messages.IirParameters(a=[1.0], b=[], covariance=[0.0] * 9, reason='none'),
        DiagnosticArray(status=status),
        messages.StrutAcceleration(),
    ]  # fmt: skip


def texts_of(value):
    if isinstance(value, str):
        return [value]
    if isinstance(value, list):
        return [text for part in value for text in texts_of(part)]
    if hasattr(value, 'get_fields_and_field_types'):
        fields = value.get_fields_and_field_types()
        return [text for name in fields for text in texts_of(getattr(value, name))]
    return []


@pytest.mark.parametrize('number', range(5))
def test_each_text_is_where_it_is_said_to_be(number):
    """Truth: the texts of the message, which stand there with their zero."""
    from rclpy.serialization import serialize_message
    from satvib_common.ros.delivery.texts import spans_of_texts

    message = examples()[number]
    data = serialize_message(message)
    found = [data[begin:end] for begin, end in spans_of_texts(data, type(message))]
    assert found == [text.encode() + b'\0' for text in texts_of(message)]


def test_numbers_in_a_fixed_list_are_passed_over():
    """Truth: the message's text follows 36 numbers and more."""
    from geometry_msgs.msg import PoseWithCovarianceStamped
    from rclpy.serialization import serialize_message
    from satvib_common.ros.delivery.texts import spans_of_texts

    message = PoseWithCovarianceStamped()
    message.header.frame_id = 'base'
    data = serialize_message(message)
    ((begin, end),) = spans_of_texts(data, PoseWithCovarianceStamped)
    assert data[begin:end] == b'base\0'


def test_bytes_that_end_early_are_refused():
    """Truth: a text of 1000 bytes does not stand in 40."""
    from satvib_common.ros.delivery.texts import spans_of_texts

    data = b'\0\1\0\0' + bytes(8) + (1000).to_bytes(4, 'little') + bytes(24)
    with pytest.raises(ValueError, match='end within a text'):
        spans_of_texts(data, messages.StrutAcceleration)
