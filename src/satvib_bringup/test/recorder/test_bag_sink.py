# SPDX-FileCopyrightText: 2026 The satvib authors
# SPDX-License-Identifier: Apache-2.0
"""Bags as they are written, and what is left of one whose writer was killed. No ROS: definitions are given as text."""

import struct
from io import BytesIO

import pytest
from rosbags.highlevel import AnyReader
from rosbags.interfaces import (
    Qos,
    QosDurability,
    QosHistory,
    QosLiveliness,
    QosReliability,
    QosTime,
)
from rosbags.typesys import Stores, get_types_from_msg, get_typestore
from satvib_bringup.recorder.bag_sink import BagSink, Channel, ChunkIndex
from satvib_bringup.recorder.check import Expected, complaint
from satvib_bringup.recorder.message_text import type_hash
from satvib_bringup.recorder.salvage import salvage
from satvib_common.errors import SatvibError
from satvib_experiment.recording.cdr import stamp_and_sequence

KIND = 'satvib_test/msg/Sample'
TEXT = (
    'std_msgs/Header header\nuint64 sequence\nfloat64 value\n'
    + '=' * 80
    + '\nMSG: std_msgs/Header\nbuiltin_interfaces/Time stamp\nstring frame_id\n'
    + '=' * 80
    + '\nMSG: builtin_interfaces/Time\nint32 sec\nuint32 nanosec'
)
ZERO = QosTime(0, 0)
QOS = Qos(
    QosHistory.KEEP_LAST, 10, QosReliability.RELIABLE, QosDurability.TRANSIENT_LOCAL, ZERO, ZERO,
    QosLiveliness.AUTOMATIC, ZERO, avoid_ros_namespace_conventions=False,
)  # fmt: skip


def channel(topic='/strut_1/sample'):
    return Channel(topic, KIND, TEXT, type_hash(KIND, TEXT), QOS)


def serialized(k, frame='strut_1'):
    """CDR by hand: encapsulation, stamp, text, padding, sequence, value."""
    text = frame.encode() + b'\0'
    head = struct.pack('<iII', k // 100, (k % 100) * 10_000_000, len(text)) + text
    head += b'\0' * (-len(head) % 8)
    return b'\0\1\0\0' + head + struct.pack('<Qd', k, 0.5 * k)


def write(folder, count):
    sink = BagSink(folder, {'key': 'text'})
    made = channel()
    for k in range(count):
        sink.put(made, k * 10_000_000, serialized(k))
    return sink


def read(folder):
    with AnyReader([folder]) as reader:
        return [
            (time, reader.deserialize(raw, connection.msgtype))
            for connection, time, raw in reader.messages()
        ]


@pytest.mark.parametrize('frame', ['', 'a', 'strut_1', 'strut_10', 'a_much_longer_name'])
def test_stamp_and_sequence_are_found_without_deserializing(frame):
    """Truth: rosbags' own CDR reader, for names of every alignment."""
    store = get_typestore(Stores.EMPTY)
    store.register(get_types_from_msg(TEXT, KIND))
    for k in (0, 1, 99, 12_345_678_901):
        message = serialized(k % 10**9 if k > 10**9 else k, frame)
        decoded = store.deserialize_cdr(message, KIND)
        stamp = decoded.header.stamp.sec * 10**9 + decoded.header.stamp.nanosec
        assert stamp_and_sequence(message) == (stamp, decoded.sequence)


def test_everything_that_was_put_is_in_the_bag(tmp_path):
    """Truth: the independent AnyReader of rosbags; order, time and every value."""
    write(tmp_path / 'bag', 5000).close()
    found = read(tmp_path / 'bag')
    assert [(t, m.sequence, m.value) for t, m in found] == [
        (k * 10_000_000, k, 0.5 * k) for k in range(5000)
    ]


def test_the_index_of_chunks_is_that_of_a_list():
    """Truth: a list of the same entries."""
    index, entries = ChunkIndex(), [b'first', b'', b'another one']
    for text in entries:
        entry = BytesIO()
        entry.write(text)
        index.append(entry)
    assert len(index) == 3
    assert [(entry.getvalue(), entry.tell()) for entry in index] == [(t, len(t)) for t in entries]


def test_a_killed_recorder_leaves_a_readable_bag(tmp_path):
    """Truth: a copy of the file taken before it was closed, and cut in the middle of a record."""
    sink = write(tmp_path / 'whole', 3000)
    while sink.written < 3000:
        pass
    sink._end.set()
    sink._thread.join()
    sink._flush()
    unfinished = (tmp_path / 'whole' / 'whole.mcap').read_bytes()
    sink.close()
    for cut in (0, 1, 1000):
        bag = tmp_path / f'bag_{cut}'
        bag.mkdir()
        (bag / f'{bag.name}.mcap').write_bytes(unfinished[: len(unfinished) - cut])
        count = salvage(bag, {'key': 'text'})
        assert 0 < count <= 3000
        assert [m.sequence for _, m in read(bag)] == list(range(count))
        with AnyReader([bag]) as reader:
            assert reader.connections[0].digest == type_hash(KIND, TEXT)
            assert (
                reader.connections[0].ext.offered_qos_profiles[0].durability
                == QosDurability.TRANSIENT_LOCAL
            )
        assert [p.name for p in tmp_path.iterdir() if p.name.startswith('.')] == []


def test_nothing_is_salvaged_from_nothing(tmp_path):
    """Truth: an empty file has no message; a finished bag needs no help."""
    (tmp_path / 'bag').mkdir()
    (tmp_path / 'bag' / 'bag.mcap').write_bytes(b'')
    assert salvage(tmp_path / 'bag', {}) == 0
    write(tmp_path / 'good', 10).close()
    before = (tmp_path / 'good' / 'good.mcap').read_bytes()
    assert salvage(tmp_path / 'good', {}) == 0
    assert (tmp_path / 'good' / 'good.mcap').read_bytes() == before


def test_an_existing_folder_is_not_touched(tmp_path):
    """Truth: the house rule: nothing overwritten."""
    (tmp_path / 'bag').mkdir()
    with pytest.raises(SatvibError, match='exists already'):
        BagSink(tmp_path / 'bag', {})
    (tmp_path / 'file').write_text('mine')
    with pytest.raises(SatvibError, match='cannot be made'):
        BagSink(tmp_path / 'file' / 'bag', {})


EXPECTED = Expected(samples=60, models=26, states=60, truths=6)


def report(**counts):
    """Of a recorder that lost nothing, but for what is given."""
    wanted = {
        'acceleration': 60, 'voltage': 60, 'controller_state': 60, 'truth': 6,
        'identified_model': 26,
    }  # fmt: skip
    found = {
        f'/strut_1/{name}': {'count': count, 'first': 0, 'last': count - 1, 'gaps': 0}
        for name, count in (wanted | counts).items()
    }
    found['/strut_1/truth']['gaps'] = 45  # nine samples between two blocks
    return found | {'/schedule': {'count': 1}}


def test_an_incomplete_recording_is_told():
    """Truth: one thing taken away at a time."""
    good, struts = report(), ('strut_1',)
    assert complaint(good, struts, EXPECTED) == ''
    assert '0 messages on /strut_2' in complaint(good, ('strut_1', 'strut_2'), EXPECTED)
    for lost in ('acceleration', 'voltage', 'controller_state', 'truth', 'identified_model'):
        count = good[f'/strut_1/{lost}']['count']
        assert f'strut_1/{lost}' in complaint(report(**{lost: count - 1}), struts, EXPECTED)
        gap = good | {f'/strut_1/{lost}': {'count': count, 'first': 1, 'last': 60, 'gaps': 1}}
        assert ('gaps' in complaint(gap, struts, EXPECTED)) is (lost != 'identified_model')
    assert 'schedule' in complaint(good | {'/schedule': {'count': 0}}, struts, EXPECTED)


def test_in_real_time_states_may_be_fewer_than_samples():
    """Truth: the parameter state_period; every tenth sample, and more where something has changed."""
    expected = EXPECTED._replace(states=6)
    for count, words in ((5, 'controller_state'), (6, ''), (9, ''), (60, ''), (61, 'controller_')):
        found = complaint(report(controller_state=count), ('strut_1',), expected)
        assert words in found
        assert bool(words) is bool(found)
