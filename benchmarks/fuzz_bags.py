# SPDX-FileCopyrightText: 2026 The satvib authors
# SPDX-License-Identifier: Apache-2.0
"""Bags, damaged in every way: each is read, or refused in one line, within two seconds and 500 MB.

A bag of a short run is written as MCAP (plain, with zstd) and as a database, with and without metadata.yaml, and is
then damaged: bytes, lengths, pieces cut out, moved, doubled, and the end cut off. Half of the files are read with
`recover`. Of a file whose end was cut off, what is read must be what was written, to the last bit.

    .venv/bin/python benchmarks/fuzz_bags.py --files 100000 --log bags.json
"""

import shutil
import tempfile
from functools import cache
from pathlib import Path

import numpy as np
from fuzzing import arguments_of, damage, judged, run
from rosbags.rosbag2 import CompressionFormat, CompressionMode, StoragePlugin, Writer
from rosbags.typesys import Stores, get_types_from_msg, get_typestore
from satvib_experiment.analysis.evaluation import evaluate
from satvib_experiment.recording.bag_reader import read_recording

MESSAGES = Path(__file__).resolve().parents[1] / 'src' / 'satvib_msgs' / 'msg'
SAMPLES = 80
STRUTS = ('strut_1', 'strut_2')
KINDS = ('mcap', 'mcap, zstd', 'db3')


def _upper(strut, k):
    return float(np.sin(0.3 * k + strut))


@cache
def good(kind):
    """The file and the metadata of a whole bag."""
    store = get_typestore(Stores.ROS2_JAZZY)
    for path in MESSAGES.glob('*.msg'):
        store.register(get_types_from_msg(path.read_text(), f'satvib_msgs/msg/{path.stem}'))
    with tempfile.TemporaryDirectory() as folder:
        bag = Path(folder) / 'bag'
        plugin = StoragePlugin.SQLITE3 if kind == 'db3' else StoragePlugin.MCAP
        writer = Writer(bag, version=9, storage_plugin=plugin)
        if kind == 'mcap, zstd':
            writer.set_compression(CompressionMode.STORAGE, CompressionFormat.ZSTD)
        with writer:
            _write(store, writer)
        data = next(p for p in bag.iterdir() if p.suffix != '.yaml').read_bytes()
        return data, (bag / 'metadata.yaml').read_bytes()


def _write(store, writer):
    types = store.types
    stamp = types['builtin_interfaces/msg/Time'](sec=1, nanosec=5)
    header = types['std_msgs/msg/Header'](stamp=stamp, frame_id='strut')

    def put(topic, short, messages):
        kind = f'satvib_msgs/msg/{short}'
        connection = writer.add_connection(topic, kind, typestore=store)
        for k, values in enumerate(messages):
            message = types[kind](header=header, **values)
            writer.write(connection, 10**9 + k, store.serialize_cdr(message, kind))

    plan = {
        'scenario': 'fuzz', 'seed': 3, 'sample_period': 0.01, 'struts': list(STRUTS), 'end_sequence': SAMPLES,
        'phases': np.array([0, 4], dtype=np.uint8), 'first_sequence': np.array([0, 40], dtype=np.uint64),
    }  # fmt: skip
    put('/schedule', 'Schedule', [plan])
    for i, strut in enumerate(STRUTS):
        samples = [
            {'sequence': k, 'sample_period': 0.01, 'upper': _upper(i, k), 'lower': 0.5}
            for k in range(SAMPLES)
        ]
        # a message may have got further fields since
        known = {name for name, _ in store.fielddefs['satvib_msgs/msg/StrutAcceleration'][1]}
        further = dict.fromkeys(known - {'header', *samples[0]}, False)
        put(f'/{strut}/acceleration', 'StrutAcceleration', [s | further for s in samples])
        volts = [
            {'sequence': k, 'voltage': 0.1 * k, 'saturated': False, 'fault': False}
            for k in range(SAMPLES)
        ]
        put(f'/{strut}/voltage', 'VcaVoltage', volts)


def trial(generator, path):
    """Write one damaged bag and read it: which kind and what was done to it, what came of it."""
    kind = KINDS[generator.integers(0, len(KINDS))]
    data, metadata = good(kind)
    folder = path.parent / 'bag'
    shutil.rmtree(folder, ignore_errors=True)
    folder.mkdir()
    file = folder / ('bag.db3' if kind == 'db3' else 'bag.mcap')
    with_metadata, recover = generator.random() < 0.3, bool(generator.random() < 0.5)
    if with_metadata and generator.random() < 0.3:
        what, metadata = damage(generator, metadata)
        what = f'metadata: {what}'
    else:
        what, data = damage(generator, data, good(KINDS[generator.integers(0, 2)])[0])
    file.write_bytes(data)
    path.write_bytes(data)
    if with_metadata:
        (folder / 'metadata.yaml').write_bytes(metadata)
    found, recording = judged(lambda: _read(folder if with_metadata or recover else file, recover))
    if recording is not None and what == 'cut':
        found = _checked(recording)
    return f'{kind}, {what}', found


def _read(path, recover):
    recording = read_recording(path, recover)
    evaluate(recording)
    return recording


def _checked(recording):
    """Whether what was read of a file without its end is what was written, and whether that is said."""
    present = recording.get('acceleration', 'present')
    upper = recording.get('acceleration', 'upper')
    for i, name in enumerate(recording.struts):
        wanted = np.array([_upper(STRUTS.index(name), int(k)) for k in recording.sequence])
        if not np.array_equal(upper[present[:, i], i], wanted[present[:, i]]):
            return 'WRONG, other values'
    return 'read, said' if recording.notes else 'WRONG, NOT SAID'


if __name__ == '__main__':
    run(trial, arguments_of(__doc__).parse_args(), '.bag')
