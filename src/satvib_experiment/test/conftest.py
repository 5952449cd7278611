# SPDX-FileCopyrightText: 2026 The satvib authors
# SPDX-License-Identifier: Apache-2.0
"""Runs that several test files look at, and a writer of bags from the message definitions alone."""

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from rosbags.rosbag2 import CompressionFormat, CompressionMode, StoragePlugin, Writer
from rosbags.typesys import Stores, get_types_from_msg, get_typestore
from satvib_common.phases import Phase, PhasePlan
from satvib_experiment.recording.bag_reader import custom_data
from satvib_experiment.recording.recording import Recording
from satvib_experiment.recording.topics import TOPICS
from satvib_experiment.scenario.scenario import load_scenario
from satvib_experiment.twin.closed_loop import simulate

MESSAGES = Path(__file__).resolve().parents[2] / 'satvib_msgs' / 'msg'


@pytest.fixture(scope='session')
def quick():
    """The scenario of four seconds."""
    return load_scenario('quick_3dof')


@pytest.fixture(scope='session')
def quick_run(quick):
    """Its recording."""
    return simulate(quick)


@pytest.fixture(scope='session')
def synthetic():
    """Make a recording of plain arrays: no simulation, so that every figure can be worked out by hand."""

    def make(upper, dt=0.01, true=None, phases=None, **groups):
        samples, struts = upper.shape
        present = np.ones((samples, struts), dtype=bool)
        found = {'acceleration': {'upper': upper, 'lower': np.zeros_like(upper)}}
        if true is not None:
            found['truth'] = {'upper': true, 'lower': np.zeros_like(true)}
        found |= {name: dict(group) for name, group in groups.items()}
        for group in found.values():
            group.setdefault('present', present)
        steps = phases or [(Phase.STANDBY, 0.0), (Phase.CONTROL, samples * dt / 2)]
        return Recording(
            struts=tuple(f'strut_{i + 1}' for i in range(struts)),
            sample_period=dt,
            plan=PhasePlan.from_seconds(steps, samples * dt, 1.0 / dt),
            sequence=np.arange(samples),
            stamp=(np.arange(samples) * dt * 1e9).astype(np.int64),
            groups=found,
            source='synthetic',
        )

    return make


def _typestore():
    store = get_typestore(Stores.ROS2_JAZZY)
    for path in MESSAGES.glob('*.msg'):
        store.register(get_types_from_msg(path.read_text(), f'satvib_msgs/msg/{path.stem}'))
    return store


def _schedule(store, recording):
    plan = recording.plan
    cls = store.types['satvib_msgs/msg/Schedule']
    return cls(
        header=_header(store, 0),
        scenario=recording.scenario.name if recording.scenario else '',
        seed=recording.seed,
        sample_period=recording.sample_period,
        struts=list(recording.struts),
        phases=np.array(plan.phases, dtype=np.uint8),
        first_sequence=np.array(plan.first, dtype=np.uint64),
        end_sequence=plan.end,
    )


def _header(store, nanoseconds):
    stamp = store.types['builtin_interfaces/msg/Time'](
        sec=int(nanoseconds // 10**9), nanosec=int(nanoseconds % 10**9)
    )
    return store.types['std_msgs/msg/Header'](stamp=stamp, frame_id='')


def _message(store, cls, recording, group, k, strut):
    values = {}
    for name, (kind, _) in store.fielddefs[cls.__msgtype__][1]:
        del kind
        array = recording.groups[group].get(name)
        if name == 'header':
            values[name] = _header(store, recording.stamp[k])
        elif name == 'sequence':
            values[name] = int(recording.sequence[k])
        elif name == 'phase':
            values[name] = int(recording.plan.at(int(recording.sequence[k])))
        elif name == 'sample_period':
            values[name] = recording.sample_period
        elif array is None:
            values[name] = _filler(cls, name)
        else:
            item = array[k, strut]
            values[name] = item if isinstance(item, np.ndarray) else item.item()
            if name in {'updates', 'excitation_order'}:
                values[name] = int(item)
    return cls(**values)


def _filler(cls, name):
    hint = cls.__dataclass_fields__[name].type
    if 'ndarray' in hint:
        return np.zeros(0)
    if 'str' in hint:
        return ''
    return 0.0 if 'float' in hint else False if 'bool' in hint else 0


def _write_diagnostics(store, writer, diagnostics):
    kind = 'diagnostic_msgs/msg/DiagnosticArray'
    connection = writer.add_connection('/diagnostics', kind, typestore=store)
    for node, key, value in diagnostics:
        pair = store.types['diagnostic_msgs/msg/KeyValue'](key=key, value=value)
        status = store.types['diagnostic_msgs/msg/DiagnosticStatus'](
            level=0, name=node, message='', hardware_id='', values=[pair]
        )
        array = store.types[kind](header=_header(store, 0), status=[status])
        writer.write(connection, 0, store.serialize_cdr(array, kind))


def write_bag(
    recording, path, keep=lambda *_: True, groups=tuple(TOPICS), custom=True, diagnostics=(), schedule=True,
    storage=StoragePlugin.MCAP, compression=CompressionMode.NONE, foreign=(), strangers=(),
):  # fmt: skip
    """Write a recording as a bag.

    keep(group, strut, k) drops messages; diagnostics are (node, key, value); foreign are topics of std_msgs/msg/Empty;
    strangers are changes of the schedule, each another message after the run's own.
    """
    store = _typestore()
    made = Writer(path, version=9, storage_plugin=storage)
    if compression is not CompressionMode.NONE:
        made.set_compression(compression, CompressionFormat.ZSTD)
    with made as writer:
        for topic in foreign:
            kind = 'std_msgs/msg/Empty'
            connection = writer.add_connection(topic, kind, typestore=store)
            writer.write(connection, 0, store.serialize_cdr(store.types[kind](), kind))
        if custom and recording.scenario:
            for key, text in custom_data(recording.scenario, recording.rig, False).items():
                writer.set_custom_data(key, text)
        if schedule:
            kind = 'satvib_msgs/msg/Schedule'
            connection = writer.add_connection('/schedule', kind, typestore=store)
            message = _schedule(store, recording)
            for change in ({}, *strangers):
                changed = replace(message, **change)
                writer.write(connection, 0, store.serialize_cdr(changed, kind))
        if diagnostics:
            _write_diagnostics(store, writer, diagnostics)
        for group in groups:
            if not recording.has(group):
                continue
            topic, message = TOPICS[group]
            kind = f'satvib_msgs/msg/{message}'
            cls = store.types[kind]
            for strut, name in enumerate(recording.struts):
                connection = writer.add_connection(f'/{name}/{topic}', kind, typestore=store)
                for k in range(len(recording.sequence)):
                    if keep(group, strut, k):
                        data = _message(store, cls, recording, group, k, strut)
                        stamp = int(recording.stamp[k])
                        writer.write(connection, stamp, store.serialize_cdr(data, kind))
    return path


@pytest.fixture(scope='session')
def bag_writer():
    """Give `write_bag`."""
    return write_bag
