# SPDX-FileCopyrightText: 2026 The satvib authors
# SPDX-License-Identifier: Apache-2.0
"""Makes a readable bag of what a killed recorder has left: an MCAP file without index and metadata.yaml."""

import shutil
from collections.abc import Mapping
from pathlib import Path

from mcap.records import Channel, Message, Schema
from rosbags.interfaces import Connection, Qos
from rosbags.rosbag2.metadata import parse_qos
from ruamel.yaml import YAML
from satvib_experiment.recording.bag.mcap_file import McapFile

from satvib_bringup.recorder.bag_sink import open_bag
from satvib_bringup.recorder.message_text import type_hash


def is_finished(bag: Path) -> bool:
    """Whether a bag was closed as it should be."""
    return (bag / 'metadata.yaml').exists()


def salvage(bag: Path, custom: Mapping[str, str]) -> int:
    """Replace an unfinished bag by a finished one with all its complete messages.

    Args:
        bag: its folder, with one .mcap file inside.
        custom: texts stored beside the messages.

    Returns:
        How many messages there are; 0: nothing was left, and nothing is changed.

    Raises:
        OSError: there is no room for a second bag; the unfinished one is as it was.
    """
    broken = next(iter(bag.glob('*.mcap')), None)
    if broken is None or is_finished(bag):
        return 0
    workshop = bag.with_name(f'.{bag.name}.salvage')
    shutil.rmtree(workshop, ignore_errors=True)
    try:
        count = _copy(broken, workshop / bag.name, custom)
        if count:
            shutil.rmtree(bag)
            (workshop / bag.name).rename(bag)
    finally:
        shutil.rmtree(workshop, ignore_errors=True)
    return count


def _copy(source: Path, target: Path, custom: Mapping[str, str]) -> int:
    schemas: dict[int, Schema] = {}
    connections: dict[int, Connection] = {}
    count = 0
    writer = open_bag(target, custom)
    for record in McapFile(source).records():
        if isinstance(record, Schema):
            schemas[record.id] = record
        elif isinstance(record, Channel) and record.id not in connections:
            schema = schemas[record.schema_id]
            text = schema.data.decode()
            connections[record.id] = writer.add_connection(
                record.topic,
                schema.name,
                msgdef=text,
                rihs01=type_hash(schema.name, text),
                offered_qos_profiles=_offered(record),
            )
        elif isinstance(record, Message):
            writer.write(connections[record.channel_id], record.log_time, record.data)
            count += 1
    writer.close()
    return count


def _offered(channel: Channel) -> list[Qos]:
    return parse_qos(YAML(typ='safe').load(channel.metadata.get('offered_qos_profiles', '[]')))
