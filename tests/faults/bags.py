# SPDX-FileCopyrightText: 2026 The satvib authors
# SPDX-License-Identifier: Apache-2.0
"""Whether a bag can be read to its last message, and holds what the plant published without a gap."""

from itertools import pairwise

from rosbags.highlevel import AnyReader, AnyReaderError
from satvib_bringup.recorder.salvage import is_finished, salvage

# messages of a topic, a quarter of a second
_LEAST = {'acceleration': 50, 'voltage': 50, 'controller_state': 5, 'truth': 5}
_HEAD = 50_000  # bytes; schemas and channels are shorter


def holds_messages(bag):
    """Whether messages are in a bag that is being written."""
    return any(path.stat().st_size > _HEAD for path in bag.glob('*.mcap'))


def complaints(bag):
    """What is wrong with a bag, as texts; one that was not finished is saved first, as `satvib run` does it.

    The truth goes past the fault node: each of its messages begins where the one before ended, or the recorder has lost
    some. A stranger repeats one that was there, and a second plant begins with 0.
    """
    if not bag.is_dir():
        return [f'{bag.name} is not there']
    if not is_finished(bag):
        salvage(bag, {})
    counts, truth = {}, []
    with AnyReader([bag]) as reader:
        for connection, _, raw in reader.messages():
            try:
                message = reader.deserialize(raw, connection.msgtype)
            except AnyReaderError as error:
                return [f'{bag.name}: a message of {connection.topic} cannot be read ({error})']
            counts[connection.topic] = counts.get(connection.topic, 0) + 1
            if connection.topic == '/strut_1/truth':
                truth.append((message.sequence, message.samples))
    found = [
        f'{bag.name} has {counts.get(f"/strut_1/{topic}", 0)} of {topic}'
        for topic, least in _LEAST.items()
        if counts.get(f'/strut_1/{topic}', 0) < least
    ]
    own = []
    for k, count in truth:
        if not own or k > own[-1][0]:
            own.append((k, count))
    gaps = sum(k + count != after for (k, count), (after, _) in pairwise(own))
    return found + ([f'{bag.name}: {gaps} gaps in the truth'] if gaps else [])
