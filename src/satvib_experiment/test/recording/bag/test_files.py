# SPDX-FileCopyrightText: 2026 The satvib authors
# SPDX-License-Identifier: Apache-2.0
"""Files of bags: every storage, cut, damaged, without index. Truth: the recording that was written."""

import shutil

import numpy as np
import pytest
from rosbags.rosbag2 import CompressionMode, StoragePlugin
from satvib_common.errors import SatvibError
from satvib_experiment.recording.bag.mcap_file import MAGIC
from satvib_experiment.recording.bag_reader import read_recording
from satvib_experiment.recording.recording import differences

STORAGES = {
    'mcap': {},
    'mcap, chunks compressed': {'compression': CompressionMode.STORAGE},
    'mcap, messages compressed': {'compression': CompressionMode.MESSAGE},
    'mcap, file compressed': {'compression': CompressionMode.FILE},
    'sqlite3': {'storage': StoragePlugin.SQLITE3},
    'sqlite3, file compressed': {'storage': StoragePlugin.SQLITE3, 'compression': CompressionMode.FILE},
    'sqlite3, messages compressed': {'storage': StoragePlugin.SQLITE3, 'compression': CompressionMode.MESSAGE},
}  # fmt: skip


@pytest.fixture(scope='module')
def bags(quick_run, bag_writer, tmp_path_factory):
    """A bag of each storage."""
    folder = tmp_path_factory.mktemp('bags')
    return {
        name: bag_writer(quick_run, folder / name.replace(', ', '_').replace(' ', '_'),
                         groups=('acceleration', 'voltage'), **options)
        for name, options in STORAGES.items()
    }  # fmt: skip


def file_of(bag):
    return next(path for path in bag.iterdir() if path.name != 'metadata.yaml')


@pytest.mark.parametrize('storage', STORAGES)
def test_every_storage_is_read(bags, quick_run, storage):
    back = read_recording(bags[storage])
    wanted = [
        line for line in differences(quick_run, back) if 'only one of them has it' not in line
    ]
    assert wanted == []
    assert back.scenario == quick_run.scenario
    assert not back.is_cut


@pytest.mark.parametrize('storage', [name for name in STORAGES if 'messages' not in name])
def test_the_files_are_read_without_metadata(bags, quick_run, tmp_path, storage):
    shutil.copy(file_of(bags[storage]), tmp_path)
    back = read_recording(tmp_path)
    assert np.array_equal(back.get('acceleration', 'upper'), quick_run.get('acceleration', 'upper'))
    assert 'no metadata.yaml' in back.notes[0]


@pytest.mark.parametrize('storage', [name for name in STORAGES if 'messages' not in name])
@pytest.mark.parametrize('share', [0.75, 0.9, 0.9999])
def test_what_is_whole_in_a_cut_file_is_read_and_said(bags, quick_run, tmp_path, storage, share):
    source = file_of(bags[storage])
    data = source.read_bytes()
    (tmp_path / source.name).write_bytes(data[: int(share * len(data))])
    shutil.copy(bags[storage] / 'metadata.yaml', tmp_path)
    back = read_recording(tmp_path)
    assert back.is_cut
    assert any('cut short' in note for note in back.notes)
    first = int(back.sequence[0])
    rows = slice(first, first + len(back.sequence))
    there = back.get('acceleration', 'present')
    assert there.any()
    assert np.array_equal(
        back.get('acceleration', 'upper')[there],
        quick_run.get('acceleration', 'upper')[rows][there],
    )


def test_the_end_alone_cut_off_loses_nothing(bags, quick_run, tmp_path):
    source = file_of(bags['mcap'])
    path = tmp_path / 'a.mcap'
    path.write_bytes(source.read_bytes()[: -len(MAGIC)])
    back = read_recording(path)
    assert np.array_equal(back.get('acceleration', 'upper'), quick_run.get('acceleration', 'upper'))
    assert back.is_cut


@pytest.mark.parametrize('storage', ['mcap', 'mcap, chunks compressed'])
def test_a_damaged_index_is_refused_and_what_it_points_to_is_recovered(
    bags, quick_run, tmp_path, storage
):
    """The summary is behind the messages; its last 200 bytes before the footer are made 0xff."""
    data = bytearray(file_of(bags[storage]).read_bytes())
    data[-300:-50] = b'\xff' * 250
    path = tmp_path / 'a.mcap'
    path.write_bytes(data)
    with pytest.raises(SatvibError, match=r'damaged.*--recover') as caught:
        read_recording(path)
    assert '\n' not in str(caught.value)
    back = read_recording(path, recover=True)
    assert np.array_equal(back.get('acceleration', 'upper'), quick_run.get('acceleration', 'upper'))
    assert any('damaged' in note for note in back.notes)


def test_a_database_with_damaged_pages(bags, quick_run, tmp_path):
    data = bytearray(file_of(bags['sqlite3']).read_bytes())
    page = 4096
    for first in range(len(data) // 2 // page * page, len(data) * 6 // 10, page):
        data[first : first + page] = b'\xff' * page
    path = tmp_path / 'a.db3'
    path.write_bytes(data)
    with pytest.raises(SatvibError, match='damaged'):
        read_recording(path)
    back = read_recording(path, recover=True)
    there = back.get('acceleration', 'present')
    assert 0.3 < there.mean() <= 1.0
    rows = slice(int(back.sequence[0]), int(back.sequence[-1]) + 1)
    assert np.array_equal(
        back.get('acceleration', 'upper')[there],
        quick_run.get('acceleration', 'upper')[rows][there],
    )


def test_damaged_metadata_is_refused_and_left_out(bags, quick_run, tmp_path):
    shutil.copy(file_of(bags['mcap']), tmp_path)
    (tmp_path / 'metadata.yaml').write_text('rosbag2_bagfile_information: {version: [')
    with pytest.raises(SatvibError, match=r'metadata\.yaml: damaged'):
        read_recording(tmp_path)
    back = read_recording(tmp_path, recover=True)
    assert len(back.sequence) == len(quick_run.sequence)


def test_a_strut_that_the_schedule_does_not_name_is_said(quick_run, bag_writer, tmp_path):
    """Truth: by hand: a topic is called otherwise, with as many letters."""
    first = bag_writer(quick_run, tmp_path / 'one')
    renamed = (
        file_of(first).read_bytes().replace(b'/strut_2/acceleration', b'/strut1_/acceleration')
    )
    path = tmp_path / 'a.mcap'
    path.write_bytes(renamed)
    back = read_recording(path)
    assert any('does not name were left out: strut1_' in note for note in back.notes)
