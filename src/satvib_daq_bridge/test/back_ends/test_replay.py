# SPDX-FileCopyrightText: 2026 The satvib authors
# SPDX-License-Identifier: Apache-2.0
"""Records instead of sensors. Truth: the numbers that the test wrote."""

import numpy as np
import pytest
from satvib_common.errors import SatvibError
from satvib_daq_bridge.back_ends.base import EndOfRecordError
from satvib_daq_bridge.back_ends.factory import make_back_end
from satvib_daq_bridge.channels import parse_channels
from satvib_daq_bridge.simulated.channels_from_rig import channels_of
from satvib_plant_sim.rig.rig import load_rig

RIG = load_rig('paper_3dof')
SENSITIVITY = RIG.accelerometer.sensitivity
NAMES = [f'strut_{i}.{plate}' for plate in ('upper', 'lower') for i in (1, 2, 3)]


def replay_of(path, **options):
    options = {'file': str(path), 'pace': 'lockstep', **options}
    channels = parse_channels(channels_of(RIG, 'replay', 'record', options), 'test')
    return make_back_end(channels, 0.01, 0.03)


def write_csv(path, values, names=NAMES):
    rows = [','.join(names), *(','.join(map(repr, row)) for row in values.tolist())]
    path.write_text('\n'.join(rows) + '\n')


def play(back_end, count):
    found = []
    for _ in range(count):
        (reading,) = back_end.poll(0.0)
        found.append(reading.volts)
        assert back_end.poll(0.0) == []
        back_end.write(np.zeros(3), reading.sequence, False, 0.0)
    return np.array(found)


def test_rest_until_the_run_then_every_row_then_the_end(tmp_path):
    values = np.arange(150 * 6, dtype=float).reshape(150, 6) / 1000.0
    write_csv(tmp_path / 'a.csv', values)
    back_end = replay_of(tmp_path / 'a.csv', unit='V')
    back_end.start(0.0)
    np.testing.assert_array_equal(play(back_end, 230)[100:200], values[:100])
    back_end.begin_run()
    np.testing.assert_array_equal(play(back_end, 150), values)
    with pytest.raises(EndOfRecordError, match='the record is over after 150 samples'):
        back_end.poll(0.0)


def test_accelerations_become_volts(tmp_path):
    """Truth: 2.5 V at rest, 0.5 V/g."""
    values = np.full((100, 6), 10.0)
    write_csv(tmp_path / 'a.csv', values, [f'c{i}' for i in range(6)])
    columns = {name: f'c{i}' for i, name in enumerate(NAMES)}
    back_end = replay_of(tmp_path / 'a.csv', columns=columns)
    np.testing.assert_allclose(play(back_end, 1), 2.5 + 10.0 * SENSITIVITY)


@pytest.mark.parametrize(
    ('text', 'message'),
    [
        ('', 'is empty'),
        ('a,b\n1,2\n', r"no column 'strut_1\.upper'; known: a, b"),
        (','.join(NAMES) + '\n1,2,3,4,x,6\n', r"line 2: strut_\d\.\w+ is 'x', not a number"),
        (','.join(NAMES) + '\n1,2,3\n', 'line 2: the row has 3 cells, the header 6'),
        (','.join(NAMES) + '\n1,2,3,4,5,6\n', '1 samples are less than the 1 s of rest'),
    ],
)
def test_a_broken_csv_is_reported(tmp_path, text, message):
    (tmp_path / 'a.csv').write_text(text)
    with pytest.raises(SatvibError, match=message):
        replay_of(tmp_path / 'a.csv')


def test_what_is_not_there_is_reported(tmp_path):
    with pytest.raises(SatvibError, match='cannot be read: '):
        replay_of(tmp_path / 'none.csv')
    with pytest.raises(SatvibError, match='cannot be read as a bag'):
        replay_of(tmp_path / 'none')
    write_csv(tmp_path / 'a.csv', np.zeros((100, 6)))
    with pytest.raises(SatvibError, match=r'columns\.strut_9\.upper: no such channel'):
        replay_of(tmp_path / 'a.csv', columns={'strut_9.upper': 'a'})


def write_bag(path, values, struts=3, sequences=None):
    """A bag as the recorder writes it, with as much of a type as is needed."""
    from rosbags.rosbag2 import StoragePlugin, Writer
    from rosbags.typesys import Stores, get_types_from_msg, get_typestore

    store = get_typestore(Stores.ROS2_JAZZY)
    text = 'std_msgs/Header header\nuint64 sequence\nfloat64 sample_period\nfloat64 upper\nfloat64 lower'
    name = 'satvib_msgs/msg/StrutAcceleration'
    store.register(get_types_from_msg(text, name))
    header = store.types['std_msgs/msg/Header'](
        stamp=store.types['builtin_interfaces/msg/Time'](sec=0, nanosec=0), frame_id=''
    )
    with Writer(path, version=9, storage_plugin=StoragePlugin.MCAP) as writer:
        for i in range(struts):
            connection = writer.add_connection(
                f'/strut_{i + 1}/acceleration', name, typestore=store
            )
            for k, row in enumerate(values):
                sequence = 5 + k if sequences is None else sequences[k]
                message = store.types[name](header, sequence, 0.01, row[i], row[struts + i])
                writer.write(connection, k, store.serialize_cdr(message, name))


def test_a_bag_is_played_sample_by_sample(tmp_path):
    values = np.random.default_rng([1, 0]).standard_normal((120, 6))
    write_bag(tmp_path / 'bag', values)
    back_end = replay_of(tmp_path / 'bag')
    back_end.begin_run()
    np.testing.assert_allclose(play(back_end, 120), 2.5 + SENSITIVITY * values, rtol=1e-12)


def test_a_bag_without_a_strut_is_reported(tmp_path):
    write_bag(tmp_path / 'bag', np.zeros((100, 6)), struts=2)
    with pytest.raises(
        SatvibError, match=r'no acceleration of strut_3 \(struts: strut_1, strut_2\)'
    ):
        replay_of(tmp_path / 'bag')


def test_a_damaged_bag_is_one_line(tmp_path):
    """Bytes that were turned over on the disk. Truth: it is played, or refused as a bag; nothing else is raised."""
    write_bag(tmp_path / 'bag', np.zeros((100, 6)))
    file = tmp_path / 'bag' / 'bag.mcap'
    whole, refused = file.read_bytes(), []
    rng = np.random.default_rng([3, 0])
    for _ in range(30):
        damaged = bytearray(whole)
        for place in rng.integers(len(whole), size=20):
            damaged[place] = rng.integers(256)
        file.write_bytes(damaged)
        try:
            replay_of(tmp_path / 'bag')
        except SatvibError as error:
            refused.append(str(error))
    assert len(refused) > 5
    assert not any('\n' in line for line in refused)


def test_a_bag_takes_memory_for_the_samples_that_are_in_it(tmp_path):
    """A part of a long run is played from its first sample; one sequence that is damaged is refused, and named."""
    values = np.random.default_rng([1, 0]).standard_normal((120, 6))
    late = 2**62 + np.arange(120)
    write_bag(tmp_path / 'late', values, sequences=late.tolist())
    assert replay_of(tmp_path / 'late').volts.shape == (120, 6)
    write_bag(tmp_path / 'far', values, sequences=[*range(119), 2**62])
    with pytest.raises(SatvibError, match=f'360 accelerations of samples 0 to {2**62}'):
        replay_of(tmp_path / 'far')
