# SPDX-FileCopyrightText: 2026 The satvib authors
# SPDX-License-Identifier: Apache-2.0
"""Bags that are damaged or incomplete. Truth: what was done to the bag; nothing but a `SatvibError` may be raised."""

import random
import struct
from pathlib import Path

import pytest
from satvib_common.errors import SatvibError
from satvib_experiment.analysis.evaluation import evaluate
from satvib_experiment.recording.load import load_recording

CASES = Path(__file__).resolve().parents[4].parent / 'shared' / 'cases'
GOOD = CASES / 'bag_recording_began_late' / 'bag_recording_began_late.mcap'
ZERO = CASES / 'bag_sample_period_zero' / 'bag_sample_period_zero.mcap'
pytestmark = pytest.mark.skipif(not GOOD.is_file(), reason='the bags are not here: ../shared/cases')


def refused(path, text):
    with pytest.raises(SatvibError, match=text) as caught:
        evaluate(load_recording(path))
    assert '\n' not in str(caught.value)


@pytest.mark.parametrize('kind', ['AttributeError', 'MemoryError', 'OverflowError', 'ReaderError'])
def test_a_bag_with_bytes_changed_is_said_to_be_damaged(kind):
    refused(CASES / 'bag_damaged_bytes' / f'fuzz_{kind}.mcap', 'damaged')


def test_a_recording_that_began_after_its_window():
    """Truth: the case's page: it begins at 12 s."""
    refused(GOOD, r'begins at 12\.00 s, after the uncontrolled window')


def test_a_topic_without_a_strut():
    refused(
        CASES / 'bag_topic_without_namespace' / 'bag_topic_without_namespace.mcap',
        'topic /acceleration has no name of a strut',
    )


def test_a_sample_period_of_zero():
    refused(ZERO, r'sample period 0\.0 s')


def test_a_bag_cut_anywhere_gives_what_is_whole_in_it(tmp_path):
    """Truth: the bag before it was cut."""
    data, whole = GOOD.read_bytes(), load_recording(GOOD)
    path = tmp_path / 'cut.mcap'
    for end in (0, 1, 8, 100):
        path.write_bytes(data[:end])
        refused(path, 'damaged or cut short')
    for end in (len(data) // 2, len(data) - 9, len(data) - 1):
        path.write_bytes(data[:end])
        cut = load_recording(path)
        upper, wanted = cut.get('acceleration', 'upper'), whole.get('acceleration', 'upper')
        assert 0 < len(upper) <= len(wanted)
        assert (upper == wanted[: len(upper)]).all()
        assert cut.is_cut
        assert 'cut short' in cut.notes[0]


def test_bytes_changed_at_random(tmp_path):
    """Bytes from a seed; lengths and counters are often hit by eight bytes at once."""
    data = GOOD.read_bytes()
    path = tmp_path / 'changed.mcap'
    chance = random.Random(5)
    read = 0
    for trial in range(150):
        changed = bytearray(data)
        for _ in range(chance.randint(1, 4)):
            changed[chance.randrange(len(data))] = chance.randrange(256)
        if trial % 3 == 0:
            at = chance.randrange(len(data) - 8)
            changed[at : at + 8] = struct.pack('<Q', chance.getrandbits(64))
        path.write_bytes(changed)
        try:
            load_recording(path)
        except SatvibError:
            continue
        read += 1
    assert 0 < read < 150  # some are read: what was hit is text or a number that may be anything
