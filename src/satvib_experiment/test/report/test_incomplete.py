# SPDX-FileCopyrightText: 2026 The satvib authors
# SPDX-License-Identifier: Apache-2.0
"""Reports of incomplete recordings: of what is there, with what is missing said, and no warning on the way.

Truth: what was left out by hand; figures of the struts that are there are those of the whole recording.
"""

import json

import numpy as np
import pytest
from satvib_common.errors import SatvibError
from satvib_experiment.analysis.evaluation import evaluate
from satvib_experiment.recording.bag_reader import read_recording
from satvib_experiment.recording.load import load_recording
from satvib_experiment.report.build import write_report
from satvib_experiment.report.drawing import Drawing

pytestmark = pytest.mark.filterwarnings('error')


@pytest.fixture
def copy(quick_run, tmp_path):
    """A copy of the run that may be changed."""
    path = tmp_path / 'quick.npz'
    quick_run.save(path)
    return load_recording(path)


def reported(recording, folder):
    # drawn here, so that a warning of the drawing is an error
    report = write_report(recording, folder, Drawing(0))
    result = json.loads((folder / 'result.json').read_text())
    assert report.page.is_file()
    return result


def test_one_strut_of_three_as_ros2_bag_record_leaves_it(quick_run, bag_writer, tmp_path):
    bag = bag_writer(
        quick_run, tmp_path / 'bag', keep=lambda _g, strut, _k: strut == 1, custom=False
    )
    result = reported(read_recording(bag), tmp_path / 'report')
    assert result['scenario'] == 'quick_3dof'
    assert result['seed'] == quick_run.seed
    assert result['settings'] is None
    whole = evaluate(quick_run)
    levels = [s['level']['controlled']['measured_rms'] for s in result['struts']]
    assert levels[0] is levels[2] is None
    assert levels[1] > 0.0
    assert whole.struts == tuple(s['name'] for s in result['struts'])
    notes = ' '.join(result['notes'])
    assert 'acceleration of strut_1, strut_3' in notes
    assert 'Rig, disturbance and settings are not in this bag' in notes


def test_sensors_that_give_nothing(copy, tmp_path):
    for name in ('upper', 'lower'):
        copy.groups['acceleration'][name][:] = np.nan
    result = reported(copy, tmp_path / 'report')
    assert any('NaN throughout: the upper and the lower' in note for note in result['notes'])
    assert all(s['attenuation']['measured_rms'] is None for s in result['struts'])
    assert all(s['attenuation']['true_rms'] is not None for s in result['struts'])


@pytest.mark.parametrize('share', [0.5, 0.99])
def test_samples_missing_everywhere(copy, share):
    generator = np.random.default_rng(1)
    for fields in copy.groups.values():
        lost = generator.random(fields['present'].shape) < share
        for array in fields.values():
            array[lost] = (
                np.nan if array.dtype.kind == 'f' else '' if array.dtype.kind == 'U' else 0
            )
    assert evaluate(copy).struts == copy.struts


def cut(recording, first, last):
    recording.sequence = recording.sequence[first:last]
    recording.stamp = recording.stamp[first:last]
    recording.groups = {
        group: {name: array[first:last] for name, array in fields.items()}
        for group, fields in recording.groups.items()
    }
    return recording


def test_a_recording_that_was_cut_has_no_windows_behind_its_end(copy):
    """Truth: the scenario's windows: 2.3 s and 3.4 s. One that was not cut is refused: it is no run of the scenario."""
    short = cut(copy, 0, 320)
    with pytest.raises(SatvibError, match='before the controlled window'):
        evaluate(short)
    short.is_cut = True
    found = evaluate(short)
    assert found.windows.controlled is None
    assert found.windows.uncontrolled is not None


@pytest.mark.parametrize('span', [(0, 1), (0, 2)])
def test_a_recording_of_one_or_two_samples(copy, tmp_path, span):
    short = cut(copy, *span)
    short.scenario = short.rig = None
    result = reported(short, tmp_path / 'report')
    assert result['samples'] == span[1]


@pytest.mark.parametrize('group', ['voltage', 'state', 'model', 'truth'])
def test_a_topic_that_is_missing(copy, group):
    del copy.groups[group]
    assert evaluate(copy).struts == copy.struts
