# SPDX-FileCopyrightText: 2026 The satvib authors
# SPDX-License-Identifier: Apache-2.0
"""Reading a bag into a `Recording`, with rosbags: no ROS needed, the message definitions are the bag's own.

Any rosbag2 bag will do that holds a schedule and the struts' topics, made by satvib's recorder or by
`ros2 bag record -a`. The recorder also leaves the scenario and the rig in the bag's custom data, which
`custom_data` makes.
"""

import dataclasses
from collections import Counter, defaultdict
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any

import numpy as np
import yaml
from numpy.typing import NDArray
from rosbags.highlevel import AnyReader
from satvib_common.arrays import Integers
from satvib_common.errors import SatvibError, printable
from satvib_common.files.yaml_file import parse_yaml
from satvib_common.phases import Phase, PhasePlan
from satvib_plant_sim.rig.any_rig import AnyRig, rig_from_mapping

from satvib_experiment.recording.recording import Group, Recording
from satvib_experiment.recording.topics import TOPICS
from satvib_experiment.scenario.scenario import Scenario

PACKAGE = 'satvib_msgs/msg'
_SKIPPED = ('header', 'sequence')
# bounds on what a number in a file may ask for; the rest of the bounds is the number of messages
_MOST_PER_MESSAGE = 20  # samples from first to last; a recording that lost more of them is none
_PERIODS = (1e-7, 1e3)  # s
_LONGEST_TEXT = 256  # characters of a reason that are kept
_SPARE = 1_000_000  # elements of an array that any file may ask for


def custom_data(scenario: Scenario, rig: AnyRig, realtime: bool) -> dict[str, str]:
    """Give what the recorder stores in the bag beside the messages, as texts."""
    return {
        'satvib_scenario': yaml.safe_dump(scenario.to_mapping(), sort_keys=False),
        'satvib_rig': yaml.safe_dump(rig.to_mapping(), sort_keys=False),
        'satvib_realtime': 'true' if realtime else 'false',
    }


def find_bag(path: Path) -> Path:
    """Find the bag that a path means: the bag itself, or a run's folder with the bag inside.

    Raises:
        SatvibError: there is nothing, or no bag.
    """
    if not path.exists():
        raise SatvibError(f'{path}: no such file or folder')
    if path.is_file() and path.suffix == '.mcap':
        return path
    if path.is_dir():
        for folder in (path, path / 'bag'):
            if (folder / 'metadata.yaml').is_file():
                return folder
        if list(path.rglob('*.mcap')):
            raise SatvibError(f'{path}: a bag without metadata.yaml; its recording was cut short')
    raise SatvibError(f'{path}: not a bag: neither metadata.yaml nor .mcap')


def read_recording(path: Path) -> Recording:
    """Read a bag.

    Args:
        path: the bag's folder, its .mcap file, or the folder of the run that holds it.

    Raises:
        SatvibError: not a bag, a bag without satvib's topics, a damaged bag.
    """
    bag = find_bag(path)
    try:
        with AnyReader([bag]) as reader:
            types = {c.msgtype for c in reader.connections}
            for needed in ('Schedule', 'StrutAcceleration'):
                if f'{PACKAGE}/{needed}' not in types:
                    found = ', '.join(sorted({c.topic for c in reader.connections})) or 'none'
                    raise SatvibError(
                        f'{bag}: no topic of type {PACKAGE}/{needed} in this bag; topics: {found}'
                    )
            custom = reader.readers[0].storage.metadata.custom or {}
            return _collect(bag, reader, dict(custom))
    except FileNotFoundError as error:
        raise SatvibError(f'{bag}: incomplete: {error}') from None
    except SatvibError:
        raise
    except Exception as error:  # a parser that meets damaged bytes raises anything  # noqa: BLE001
        raise SatvibError(f'{bag}: damaged or cut short: {_one_line(error)}') from None


def _one_line(error: BaseException) -> str:
    return printable(' '.join(str(error).split()), 300) or type(error).__name__


def _collect(bag: Path, reader: AnyReader, custom: dict[str, str]) -> Recording:
    schedules = list(_messages(reader, 'Schedule'))
    if not schedules:
        raise SatvibError(f'{bag}: the topic of the schedule holds no message')
    schedule = schedules[-1][1]
    struts = tuple(schedule.struts)
    period = _sample_period(bag, schedule)
    if not struts or not all(isinstance(s, str) and s.isprintable() and s for s in struts):
        raise SatvibError(f'{bag}: the schedule names no struts')
    found: dict[str, dict[str, list[Any]]] = {}
    for group, (_, kind) in TOPICS.items():
        by_strut: dict[str, list[Any]] = defaultdict(list)
        for topic, message in _messages(reader, kind):
            by_strut[_strut_of(bag, topic)].append(message)
        if by_strut:
            found[group] = by_strut
    measured = found.get('acceleration', {})
    for strut in struts:
        if not measured.get(strut):
            raise SatvibError(f'{bag}: no acceleration of {strut}, which the schedule names')
    first = min(m.sequence for s in struts for m in measured[s])
    last = max(m.sequence for s in struts for m in measured[s])
    count = max(len(measured[s]) for s in struts)
    if last - first >= _MOST_PER_MESSAGE * count + 1000 or last >= 2**62:
        raise SatvibError(
            f'{bag}: damaged: samples {first} to {last} in {count} messages of a strut'
        )
    sequence = np.arange(first, last + 1, dtype=np.int64)
    counts: Counter[str] = Counter()
    groups = {}
    for group, by_strut in found.items():
        columns = [by_strut.get(s, []) for s in struts]
        if arrays := _group(columns, first, len(sequence), group, counts):
            groups[group] = arrays
    stamp = np.zeros(len(sequence), dtype=np.int64)
    for message in measured[struts[0]]:
        nanoseconds = message.header.stamp.sec * 10**9 + message.header.stamp.nanosec
        stamp[message.sequence - first] = nanoseconds
    counts.update(_late(reader))
    for strut, messages in zip(
        struts, (found.get('state', {}).get(s, []) for s in struts), strict=True
    ):
        if messages:
            counts[f'{strut}_samples_missed_by_controller'] = int(messages[-1].missed_samples)
    scenario, rig = custom.get('satvib_scenario'), custom.get('satvib_rig')
    return Recording(
        struts=struts,
        sample_period=period,
        plan=PhasePlan(
            tuple(Phase(int(p)) for p in schedule.phases),
            tuple(int(k) for k in schedule.first_sequence),
            int(schedule.end_sequence),
        ),
        sequence=sequence,
        stamp=stamp,
        groups=groups,
        scenario=_parsed(Scenario.from_mapping, scenario, f'{bag}: scenario'),
        rig=_parsed(rig_from_mapping, rig, f'{bag}: rig'),
        realtime=custom.get('satvib_realtime') == 'true',
        seed=int(schedule.seed),
        source=str(bag),
        counts=dict(counts),
    )


def _sample_period(bag: Path, schedule: Any) -> float:
    period = schedule.sample_period
    if not isinstance(period, float) or not _PERIODS[0] <= period <= _PERIODS[1]:
        raise SatvibError(
            f'{bag}: sample period {period} s of the schedule is not from {_PERIODS[0]:g} to '
            f'{_PERIODS[1]:g} s'
        )
    return period


def _strut_of(bag: Path, topic: str) -> str:
    """Name of the strut in a topic, which is its last part but one."""
    parts = topic.strip('/').split('/')
    if len(parts) < 2:
        raise SatvibError(f'{bag}: topic {topic} has no name of a strut before it')
    return parts[-2]


def _late(reader: AnyReader) -> dict[str, int]:
    """What the nodes counted as late on /diagnostics, as they said last."""
    connections = [
        c for c in reader.connections if c.msgtype == 'diagnostic_msgs/msg/DiagnosticArray'
    ]
    said: dict[str, int] = {}
    if not connections:
        return said
    for connection, _, raw in reader.messages(connections):
        message: Any = reader.deserialize(raw, connection.msgtype)
        for status in message.status:
            for pair in status.values:
                if pair.key.startswith('late') and pair.value.isdecimal():
                    said[f'{status.name}_{pair.key}'.strip('/').replace(' ', '_')] = int(pair.value)
    return said


def _parsed(build: Callable[[Any, str], Any], text: str | None, where: str) -> Any:
    return build(parse_yaml(text, where), where) if text else None


def _messages(reader: AnyReader, kind: str) -> Iterator[tuple[str, Any]]:
    """Topic and message of every message of one type, in order of arrival."""
    connections = [c for c in reader.connections if c.msgtype == f'{PACKAGE}/{kind}']
    if not connections:
        return
    for connection, _, raw in reader.messages(connections):
        yield connection.topic, reader.deserialize(raw, connection.msgtype)


def _group(
    by_strut: list[list[Any]], first: int, count: int, group: str, counts: Counter[str]
) -> Group:
    """Turn the struts' messages of one type into arrays by sample; none when no message is of a recorded sample.

    Of a recorder that was killed the topics end at different samples: some of its messages are of samples whose
    accelerations are not in the bag.
    """
    present = np.zeros((count, len(by_strut)), dtype=bool)
    names: list[str] = []
    kept: list[list[Any]] = []
    rows: list[Integers] = []
    for strut, messages in enumerate(by_strut):
        inside = [m for m in messages if 0 <= m.sequence - first < count]
        by_row = {m.sequence - first: m for m in inside}
        counts[f'{group}_repeated'] += len(inside) - len(by_row)
        counts[f'{group}_outside_of_the_recording'] += len(messages) - len(inside)
        order = sorted(by_row)
        rows.append(np.array(order, dtype=np.int64))
        kept.append([by_row[k] for k in order])
        present[rows[-1], strut] = True
        if inside and not names:
            names = [f.name for f in dataclasses.fields(inside[0]) if f.name not in _SKIPPED]
            names = [n for n in names if not n.startswith('_')]
    if not names:
        return {}
    result: Group = {
        name: _array([[getattr(m, name) for m in messages] for messages in kept], rows, count)
        for name in names
    }
    result['present'] = present
    return result


def _array(values: list[list[Any]], rows: list[Integers], count: int) -> NDArray[Any]:
    """Scatter values by strut to (count, struts, ...); NaN, zero or '' where there is none."""
    filled = [v for v in values if v]
    sample = filled[0][0]
    if isinstance(sample, str):
        width = min(max(len(text) for column in filled for text in column), _LONGEST_TEXT)
        result: NDArray[Any] = np.zeros((count, len(values)), dtype=f'U{max(width, 1)}')
    elif isinstance(sample, np.ndarray):
        width = max(len(item) for column in filled for item in column)
        given = sum(len(item) for column in filled for item in column)
        if count * len(values) * width > _SPARE + 2 * _MOST_PER_MESSAGE * given * len(values):
            raise SatvibError(f'damaged: a list of {width} in messages with {given} in all')
        result = np.full((count, len(values), width), np.nan)
        for strut, column in enumerate(values):
            for row, item in zip(rows[strut], column, strict=True):
                result[row, strut, : len(item)] = item
        return result
    elif isinstance(sample, float):
        result = np.full((count, len(values)), np.nan)
    else:
        result = np.zeros(
            (count, len(values)), dtype=bool if isinstance(sample, bool) else np.int64
        )
    for strut, column in enumerate(values):
        if column:
            result[rows[strut], strut] = column
    return result
