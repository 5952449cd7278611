# SPDX-FileCopyrightText: 2026 The satvib authors
# SPDX-License-Identifier: Apache-2.0
"""Recordings on disk and their comparison."""

import numpy as np
import pytest
from satvib_common.errors import SatvibError
from satvib_common.phases import Phase
from satvib_experiment.recording.load import load_recording
from satvib_experiment.recording.npz_file import load_npz
from satvib_experiment.recording.recording import differences


def test_what_is_saved_comes_back(quick_run, tmp_path):
    """Truth: the recording before it was saved; every bit and every setting."""
    quick_run.save(tmp_path / 'recording.npz')
    back = load_recording(tmp_path)
    assert differences(quick_run, back) == []
    assert back.scenario == quick_run.scenario
    assert back.rig == quick_run.rig
    assert back.plan == quick_run.plan
    assert back.struts == quick_run.struts
    np.testing.assert_array_equal(back.stamp, quick_run.stamp)


def test_nothing_is_overwritten(synthetic, tmp_path):
    """Truth: the file has the bytes it had before."""
    path = tmp_path / 'recording.npz'
    path.write_bytes(b'dear to me')
    with pytest.raises(SatvibError, match='exists already, not overwritten'):
        synthetic(np.zeros((5, 1))).save(path)
    assert path.read_bytes() == b'dear to me'


@pytest.mark.parametrize('content', [b'', b'not a zip', b'PK\x03\x04broken'])
def test_a_file_that_is_no_recording_is_named(tmp_path, content):
    """Truth: by hand."""
    path = tmp_path / 'x.npz'
    path.write_bytes(content)
    with pytest.raises(SatvibError, match=r'x\.npz: not a satvib recording'):
        load_npz(path)
    with pytest.raises(SatvibError, match=r'y\.npz: no such file'):
        load_npz(tmp_path / 'y.npz')


def test_one_bit_is_a_difference(synthetic):
    """Truth: by hand: the last bit of one number, and the sign of a zero."""
    upper = np.ones((20, 2))
    one = synthetic(upper.copy())
    other = synthetic(upper.copy())
    assert differences(one, other) == []
    other.groups['acceleration']['upper'][7, 1] = np.nextafter(1.0, 2.0)
    assert differences(one, other) == [
        'acceleration.upper: 1 of 40 differ, first at sample 7 of strut_2'
    ]
    other.groups['acceleration']['upper'][7, 1] = 1.0
    other.groups['acceleration']['lower'][3, 0] = -0.0
    assert differences(one, other) == [
        'acceleration.lower: 1 of 40 differ, first at sample 3 of strut_1'
    ]


def test_nan_equals_nan_and_missing_messages_are_told(synthetic):
    """Truth: by hand."""
    upper = np.full((20, 2), np.nan)
    one, other = synthetic(upper), synthetic(upper.copy())
    assert differences(one, other) == []
    other.groups['acceleration']['present'] = np.ones((20, 2), dtype=bool)
    other.groups['acceleration']['present'][4, 0] = False
    assert differences(one, other) == ['acceleration: messages missing in one of them']


def test_windows_phases_and_losses(synthetic):
    """Truth: by hand, at 100 Hz, recorded from sample 100 on."""
    made = synthetic(np.zeros((400, 2)))
    made.sequence = made.sequence + 100
    assert made.window(1.5, 2.0) == slice(50, 100)
    assert made.window(0.0, 1.2) == slice(0, 20)
    assert made.time[0] == pytest.approx(1.0)
    assert [p for p, _, _ in made.phases()] == [Phase.STANDBY, Phase.CONTROL]
    made.groups['acceleration']['present'][5, 1] = False
    assert made.lost() == {'acceleration': 1}
    with pytest.raises(SatvibError, match='no voltage of topic voltage was recorded'):
        made.get('voltage', 'voltage')
