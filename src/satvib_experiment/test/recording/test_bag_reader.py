# SPDX-FileCopyrightText: 2026 The satvib authors
# SPDX-License-Identifier: Apache-2.0
"""Bags: written by rosbags from the message definitions, read back; and every way in which a bag can be none."""

import numpy as np
import pytest
from satvib_common.errors import SatvibError
from satvib_experiment.analysis.evaluation import evaluate
from satvib_experiment.analysis.notes import notes_for
from satvib_experiment.recording.bag_reader import read_recording
from satvib_experiment.recording.load import load_recording
from satvib_experiment.recording.recording import differences


@pytest.fixture(scope='module')
def bag(quick_run, bag_writer, tmp_path_factory):
    return bag_writer(quick_run, tmp_path_factory.mktemp('run') / 'bag')


def test_a_bag_gives_the_recording_back(bag, quick_run):
    """Truth: the recording that was written, to the last bit, with its scenario and rig."""
    back = read_recording(bag)
    assert differences(quick_run, back) == []
    assert set(back.groups) == set(quick_run.groups)
    assert back.scenario == quick_run.scenario
    assert back.rig == quick_run.rig
    assert back.plan == quick_run.plan
    assert back.seed == quick_run.seed
    assert back.sample_period == quick_run.sample_period
    np.testing.assert_array_equal(back.stamp, quick_run.stamp)
    assert not any(back.lost().values())


def test_the_folder_of_the_run_and_the_file_will_do(bag, quick_run):
    """Truth: the same recording by its folder, its file and the folder of the run."""
    for path in (bag.parent, next(bag.glob('*.mcap'))):
        assert len(load_recording(path).sequence) == len(quick_run.sequence)


def test_a_bag_without_custom_data_is_read_too(quick_run, bag_writer, tmp_path):
    """As `ros2 bag record` makes it. Truth: the same samples; scenario and rig are unknown."""
    back = read_recording(bag_writer(quick_run, tmp_path / 'plain', custom=False))
    assert back.scenario is None
    assert back.rig is None
    assert differences(quick_run, back) == []


def test_lost_and_repeated_messages_are_counted(quick_run, bag_writer, tmp_path):
    """Truth: what was left out by hand: 3 voltages of strut 2, 1 acceleration of strut 1."""

    def keep(group, strut, k):
        lost = (group == 'voltage' and strut == 1 and k in {10, 11, 200}) or (
            group == 'acceleration' and strut == 0 and k == 50
        )
        return not lost

    back = read_recording(bag_writer(quick_run, tmp_path / 'gaps', keep=keep))
    assert back.lost() == {'acceleration': 1, 'voltage': 3, 'state': 0, 'truth': 0}
    assert np.isnan(back.get('voltage', 'voltage')[200, 1])
    assert np.isnan(back.get('acceleration', 'upper')[50, 0])
    assert back.get('acceleration', 'upper')[51, 0] == quick_run.get('acceleration', 'upper')[51, 0]


def test_a_bag_that_begins_late_keeps_its_sequence(quick_run, bag_writer, tmp_path):
    """Truth: recorded from sample 150 on."""
    back = read_recording(
        bag_writer(quick_run, tmp_path / 'late', keep=lambda _group, _strut, k: k >= 150)
    )
    assert back.sequence[0] == 150
    assert back.time[0] == pytest.approx(1.5)


def test_messages_of_samples_that_were_not_recorded_are_counted(quick_run, bag_writer, tmp_path):
    """As a killed recorder leaves them. Truth: by hand; the only models are of a sample after the last acceleration."""
    model = np.flatnonzero(quick_run.get('model', 'present').any(axis=1))[-1]

    def keep(group, _strut, k):
        return k == model if group == 'model' else k < model

    back = read_recording(bag_writer(quick_run, tmp_path / 'torn', keep=keep))
    assert len(back.sequence) == model
    assert not back.has('model')
    assert back.counts['model_outside_of_the_recording'] == 3
    assert back.counts['model_repeated'] == 0


def test_a_bag_without_the_topics_is_refused(quick_run, bag_writer, tmp_path):
    """Truth: only voltages were written; the message names what is missing and what is there."""
    bag = bag_writer(quick_run, tmp_path / 'other', groups=('voltage',))
    with pytest.raises(SatvibError) as caught:
        read_recording(bag)
    assert 'no topic of type satvib_msgs/msg/StrutAcceleration' in str(caught.value)
    assert '/strut_1/voltage' in str(caught.value)
    assert '\n' not in str(caught.value)


def test_a_strut_without_samples_is_said_and_the_others_are_read(quick_run, bag_writer, tmp_path):
    """Truth: nothing of strut 3 was written."""
    bag = bag_writer(quick_run, tmp_path / 'two', keep=lambda _group, strut, _k: strut != 2)
    back = read_recording(bag)
    assert back.struts == quick_run.struts
    upper = back.get('acceleration', 'upper')
    assert np.array_equal(upper[:, :2], quick_run.get('acceleration', 'upper')[:, :2])
    assert np.isnan(upper[:, 2]).all()
    assert any('acceleration of strut_3; voltage of strut_3' in note for note in back.notes)


def test_what_is_no_bag_is_named(tmp_path):
    """Truth: by hand."""
    with pytest.raises(SatvibError, match=r'nothing: no such file or folder'):
        read_recording(tmp_path / 'nothing')
    (tmp_path / 'text.txt').write_text('hello')
    with pytest.raises(SatvibError, match=r'text\.txt: not a bag'):
        read_recording(tmp_path / 'text.txt')
    with pytest.raises(SatvibError, match='not a bag'):
        read_recording(tmp_path)
    (tmp_path / 'metadata.yaml').write_text('hello: world')
    with pytest.raises(SatvibError, match='damaged'):
        read_recording(tmp_path)


@pytest.mark.parametrize('length', [0, 5, 300])
def test_a_bag_with_nothing_left_is_told(bag, tmp_path, length):
    """Truth: the file was cut after so many bytes, before any sample; the message is one line and names it."""
    whole = next(bag.glob('*.mcap'))
    cut = tmp_path / whole.name
    data = whole.read_bytes()
    cut.write_bytes(data[:length])
    (tmp_path / 'metadata.yaml').write_text((bag / 'metadata.yaml').read_text())
    with pytest.raises(SatvibError) as caught:
        read_recording(tmp_path)
    assert 'damaged or cut short' in str(caught.value)
    assert '\n' not in str(caught.value)


def test_a_bag_without_its_file(bag, tmp_path):
    """Truth: by hand."""
    (tmp_path / 'metadata.yaml').write_text((bag / 'metadata.yaml').read_text())
    with pytest.raises(SatvibError, match='missing'):
        read_recording(tmp_path)


def test_a_bag_without_metadata_is_read_with_its_scenario(bag, quick_run, tmp_path):
    """Truth: the recording that was written; the file itself holds the scenario too."""
    whole = next(bag.glob('*.mcap'))
    (tmp_path / whole.name).write_bytes(whole.read_bytes())
    back = read_recording(tmp_path)
    assert differences(quick_run, back) == []
    assert back.scenario == quick_run.scenario
    assert 'no metadata.yaml' in back.notes[0]


def test_a_bag_without_schedule_tells_struts_and_phases_by_its_messages(
    quick_run, bag_writer, tmp_path
):
    """Truth: the plan of the run."""
    back = read_recording(bag_writer(quick_run, tmp_path / 'bare', schedule=False, custom=False))
    assert back.struts == quick_run.struts
    assert back.sample_period == quick_run.sample_period
    assert (back.plan.phases, back.plan.first) == (quick_run.plan.phases, quick_run.plan.first)
    assert differences(quick_run, back) == []
    bag = bag_writer(
        quick_run, tmp_path / 'less', schedule=False, groups=('acceleration', 'voltage')
    )
    with pytest.raises(SatvibError, match='the phases are not known'):
        read_recording(bag)


@pytest.mark.parametrize(
    'stranger',
    [
        {'phases': np.array([9], np.uint8), 'first_sequence': np.array([0], np.uint64)},
        {'phases': np.array([0], np.uint8), 'first_sequence': np.array([0], np.uint64)},
        {'first_sequence': np.arange(5, dtype=np.uint64)},
    ],
    ids=['an unknown phase', 'STANDBY for ever', 'other samples'],
)
def test_the_schedule_that_the_struts_followed_counts(quick_run, bag_writer, tmp_path, stranger):
    """Truth: the plan of the run. A stranger's schedule that the nodes refused is in the bag, after the run's own."""
    bag = bag_writer(quick_run, tmp_path / 'bag', strangers=(stranger, stranger))
    back = read_recording(bag)
    assert back.plan == quick_run.plan
    assert differences(quick_run, back) == []
    assert any('3 schedules that differ; the one that the struts followed' in n for n in back.notes)


def test_the_schedule_names_the_scenario_of_a_bag_without_it(quick_run, bag_writer, tmp_path):
    """Truth: the scenario that ran."""
    back = read_recording(bag_writer(quick_run, tmp_path / 'plain', custom=False))
    assert back.name == 'quick_3dof'
    assert any('names scenario quick_3dof' in n and 'not in this bag' in n for n in back.notes)


def test_foreign_types_under_our_names_are_said(quick_run, bag_writer, tmp_path):
    """Truth: by hand."""
    bag = bag_writer(
        quick_run,
        tmp_path / 'foreign',
        foreign=('/strut_1/truth', '/clock'),
        groups=('acceleration',),
    )
    back = read_recording(bag)
    told = [n for n in back.notes if 'std_msgs/msg/Empty' in n]
    assert len(told) == 1
    assert '/strut_1/truth' in told[0]


def test_what_the_nodes_counted_as_late_is_told(quick_run, bag_writer, tmp_path):
    """Truth: the last count of each node; what is no count, or is zero, is not told as late."""
    said = [
        ('plant_sim', 'late voltages', '2'),
        ('plant_sim', 'late voltages', '7'),
        ('plant_sim', 'sequence', '400'),
        ('strut_1', 'late models', '0'),
    ]
    back = read_recording(
        bag_writer(quick_run, tmp_path / 'late', groups=('acceleration',), diagnostics=said)
    )
    assert back.counts['plant_sim_late_voltages'] == 7
    assert 'plant_sim_sequence' not in back.counts
    notes = notes_for(back, evaluate(back))
    assert any('plant sim late voltages 7' in n for n in notes)
    assert not any('late models' in n for n in notes)
