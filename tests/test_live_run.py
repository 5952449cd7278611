# SPDX-FileCopyrightText: 2026 The satvib authors
# SPDX-License-Identifier: Apache-2.0
"""The whole graph of a short scenario, live over DDS: what was recorded, and what it must equal."""

import json
from pathlib import Path

import numpy as np
import pytest
from satvib_common.phases import Phase

# fields that describe the machine, not the experiment
MACHINE = {('state', 'compute_time'), ('state', 'time_step')}


@pytest.fixture(scope='session')
def live(tmp_path_factory, new_domain):
    """One recorded run of the shortest scenario, and the scenario."""
    from satvib_bringup.live.run import run_experiment
    from satvib_experiment.scenario.scenario import load_scenario

    folder = tmp_path_factory.mktemp('live')
    scenario = load_scenario('quick_3dof')
    seen = []
    with new_domain(folder):
        outcome = run_experiment(scenario, folder / 'run', progress=seen.append)
    assert outcome.success, outcome.message
    return scenario, outcome, seen


def recorded(path):
    from satvib_experiment.recording.bag_reader import read_recording

    return read_recording(path)


def different_bits(one, other):
    """Names of the fields of `other` in which two recordings differ, where the first has a message."""
    found = []
    for group, fields in other.groups.items():
        there = one.get(group, 'present')
        for name in set(fields) - {'present'}:
            if (group, name) in MACHINE:
                continue
            a, b = one.get(group, name)[there], other.get(group, name)[there]
            if a.dtype.kind == 'f':
                same = np.array_equal(a.view(np.int64), np.asarray(b, dtype=float).view(np.int64))
                # a NaN may have any payload after a trip through a message
                same = same or np.array_equal(a, b, equal_nan=True)
            else:
                same = np.array_equal(a, b)
            if not same:
                found.append(f'{group}.{name}')
    return found


def test_live_equals_the_offline_twin(live):
    """Truth: the offline twin, which shares the cores and nothing of ROS. Every bit of every sample."""
    from satvib_experiment.twin.closed_loop import simulate

    scenario, outcome, _ = live
    run, twin = recorded(outcome.bag), simulate(scenario)
    assert len(run.sequence) == len(twin.sequence) == outcome.samples
    assert different_bits(run, twin) == []


def test_a_second_run_is_the_same_and_another_seed_is_not(live, tmp_path, new_domain):
    """Truth: the first run, bit for bit. With another seed the measured samples must differ; the twin has that run."""
    from satvib_bringup.live.run import run_experiment
    from satvib_experiment.twin.closed_loop import simulate

    scenario, outcome, _ = live
    with new_domain(tmp_path):
        again = run_experiment(scenario, tmp_path / 'again', composition='single')
    first = recorded(outcome.bag)
    assert different_bits(first, recorded(again.bag)) == []
    other = simulate(scenario.replace(seed=scenario.seed + 1))
    assert 'acceleration.upper' in different_bits(first, other)


def test_nothing_is_lost(live):
    """Truth: the schedule. One message per sample, topic and strut; models where they are due."""
    scenario, outcome, _ = live
    report = json.loads((outcome.folder / 'recording.json').read_text())
    end = scenario.plan(100.0).end
    for strut in outcome.struts:
        assert report[f'/{strut}/truth']['count'] == end // 5
        for topic in ('acceleration', 'voltage', 'controller_state'):
            found = report[f'/{strut}/{topic}']
            assert (found['count'], found['first'], found['last'], found['gaps']) == (
                end,
                0,
                end - 1,
                0,
            )
        assert report[f'/{strut}/identified_model']['count'] > 0
    assert report['/schedule']['count'] == 1
    assert report['/diagnostics']['count'] > 0


def test_an_independent_reader_decodes_every_message(live):
    """Truth: the mcap and mcap-ros2-support packages, which share no code with the recorder."""
    from mcap.reader import make_reader
    from mcap_ros2.decoder import DecoderFactory

    _, outcome, _ = live
    counts: dict[str, int] = {}
    with next(outcome.bag.glob('*.mcap')).open('rb') as source:
        reader = make_reader(source, decoder_factories=[DecoderFactory()])
        for _, channel, _, message in reader.iter_decoded_messages():
            counts[channel.topic] = counts.get(channel.topic, 0) + 1
            if channel.topic.endswith('/acceleration'):
                assert message.header.frame_id == channel.topic.split('/')[1]
    report = json.loads((outcome.folder / 'recording.json').read_text())
    assert counts == {topic: found['count'] for topic, found in report.items()}


def test_the_bag_tells_types_and_quality_of_service(live, probe):
    """Truth: the type hashes that rosidl generated, as a live publisher announces them."""
    import yaml

    from satvib_msgs.msg import ControllerState

    _, outcome, _ = live
    probe.publisher(ControllerState, '/x')
    announced = probe.wait(lambda: probe.node.get_publishers_info_by_topic('/x'))[0]
    expected = str(announced.topic_type_hash)
    metadata = yaml.safe_load((outcome.bag / 'metadata.yaml').read_text())
    info = metadata['rosbag2_bagfile_information']
    assert info['custom_data']['satvib_realtime'] == 'false'
    topics = {
        t['topic_metadata']['name']: t['topic_metadata'] for t in info['topics_with_message_count']
    }
    state = topics['/strut_1/controller_state']
    assert state['type_description_hash'] == expected
    assert state['offered_qos_profiles'][0]['reliability'] == 'reliable'
    assert state['offered_qos_profiles'][0]['durability'] == 'transient_local'


def test_progress_is_told(live):
    """Truth: the plan. Phases come in order and the samples never go back."""
    scenario, _, seen = live
    sequences = [progress.sequence for progress in seen]
    assert sequences == sorted(sequences)
    plan = scenario.plan(100.0)
    assert all(progress.phase == plan.at(progress.sequence) for progress in seen)


def test_the_attenuation_shown_is_that_of_the_twin(live):
    """Truth: its definition, on the recorded running RMS: a sample of CONTROL against one of STANDBY with the
    disturbance on. 1e-9 dB for rounding.
    """
    scenario, outcome, seen = live
    run = recorded(outcome.bag)
    level = run.get('state', 'upper_rms')
    standby = (run.phase == Phase.STANDBY) & (run.time >= scenario.disturbance['start'])
    possible = 20.0 * np.log10(level[run.phase == Phase.CONTROL][:, None] / level[standby])
    for progress in seen:
        if progress.phase != Phase.CONTROL:
            assert np.isnan(progress.attenuation).all()
            continue
        for i, shown in enumerate(progress.attenuation):
            assert np.isnan(shown) or np.min(np.abs(possible[..., i] - shown)) < 1e-9


def test_no_process_and_no_folder_is_left(live):
    """Truth: /proc. Nothing that mentions the run's folder is alive."""
    _, outcome, _ = live
    alive = []
    for path in Path('/proc').glob('[0-9]*/cmdline'):
        try:
            if str(outcome.folder).encode() in path.read_bytes():
                alive.append(path)
        except OSError:
            continue
    assert alive == []
    assert sorted(p.name for p in outcome.folder.iterdir()) == [
        'bag',
        'logs',
        'parameters',
        'recording.json',
    ]
