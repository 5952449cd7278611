# SPDX-FileCopyrightText: 2026 The satvib authors
# SPDX-License-Identifier: Apache-2.0
"""Nodes that share a process: the same bits, every topic for outsiders, and nothing of other struts."""

import signal

import numpy as np
import pytest
from satvib_common.phases import Phase

STRUT = ('satvib_bringup', 'strut')


def recorded(scenario, folder, composition, **more):
    from satvib_bringup.live.run import run_experiment
    from satvib_experiment.recording.bag_reader import read_recording

    outcome = run_experiment(scenario, folder, composition=composition, **more)
    assert outcome.success, outcome.message
    return outcome, read_recording(outcome.bag)


@pytest.mark.parametrize('composition', ['strut', 'single'])
def test_every_composition_equals_the_offline_twin(composition, tmp_path, domain):  # noqa: ARG001
    """Truth: the offline twin, every bit of every field but those of the machine; nothing is lost."""
    from satvib_experiment.recording.recording import differences
    from satvib_experiment.scenario.scenario import load_scenario
    from satvib_experiment.twin.closed_loop import simulate

    scenario = load_scenario('quick_3dof')
    outcome, run = recorded(scenario, tmp_path / 'run', composition)
    assert differences(run, simulate(scenario)) == []
    assert not any(run.lost().values())
    assert outcome.recording['/schedule']['count'] == 1
    logs = tmp_path / 'run' / 'logs'
    started = {path.stem for path in logs.iterdir()} if logs.exists() else set()
    struts = {f'strut_{i}.strut' for i in (1, 2, 3)}
    assert started == ({'plant_sim', 'recorder'} | struts if composition == 'strut' else set())


@pytest.mark.parametrize(
    ('law', 'composition'),
    [
        ('narrowband', 'separate'),
        ('feedforward', 'single'),
        ('velocity_feedback+narrowband', 'single'),
    ],
)
def test_laws_that_take_their_model_between_two_samples(law, composition, tmp_path, domain):  # noqa: ARG001
    """Truth: the offline twin, which takes it within the sample; every bit. A model is used: there is a voltage."""
    from satvib_experiment.recording.recording import differences
    from satvib_experiment.scenario.scenario import load_scenario
    from satvib_experiment.twin.closed_loop import simulate

    scenario = load_scenario('quick_3dof', [f'controller.law={law}', 'model_period=30'])
    _, run = recorded(scenario, tmp_path / 'run', composition)
    assert differences(run, simulate(scenario)) == []
    assert np.abs(run.get('voltage', 'voltage')[run.phase == Phase.CONTROL]).max() > 0.1


def test_the_centralized_scheme_in_one_process(tmp_path, domain):  # noqa: ARG001
    """Truth: the offline twin, every bit; its identifiers have nothing to hear."""
    from satvib_experiment.recording.recording import differences
    from satvib_experiment.scenario.scenario import load_scenario
    from satvib_experiment.twin.closed_loop import simulate

    changes = ['duration=4', 'analysis={}', 'phases.2.start=2.5']
    scenario = load_scenario('soft_3dof_centralized', changes)
    _, run = recorded(scenario, tmp_path / 'run', 'single')
    assert differences(run, simulate(scenario)) == ['model: only one of them has it']


def test_estimating_goes_on_in_control(tmp_path, domain):  # noqa: ARG001
    """Truth: the offline twin, every bit. After IDENTIFY models come at hand-overs, and are waited for."""
    from satvib_experiment.recording.recording import differences
    from satvib_experiment.scenario.scenario import load_scenario
    from satvib_experiment.twin.closed_loop import simulate

    changes = ['identifier.estimate_in=[IDENTIFY, CONTROL]', 'model_period=7']
    scenario = load_scenario('quick_3dof', changes)
    _, run = recorded(scenario, tmp_path / 'run', 'single')
    assert differences(run, simulate(scenario)) == []
    there = run.get('model', 'present')[:, 0]
    control = run.phase == Phase.CONTROL
    assert 0 < there[control].sum() < control.sum() / 4
    assert there[run.phase == Phase.IDENTIFY].all()


def test_outsiders_see_every_topic_of_one_process(tmp_path, probe):
    """Truth: the schedule. An outsider who was there before the run gets every message of every topic."""
    from satvib_experiment.recording.topics import TOPICS
    from satvib_experiment.scenario.scenario import load_scenario

    from satvib_msgs import msg

    heard = {
        topic: probe.collect(getattr(msg, kind), f'/strut_2/{topic}')
        for topic, kind in TOPICS.values()
    }
    heard['progress'] = probe.collect(msg.StrutProgress, '/strut_2/progress', whole=False)
    outcome, run = recorded(load_scenario('quick_3dof'), tmp_path / 'run', 'single')
    end = len(run.sequence)
    counts = {
        topic: outcome.recording[f'/strut_2/{topic}']['count'] for topic, _ in TOPICS.values()
    }
    probe.wait(lambda: all(len(heard[topic]) == count for topic, count in counts.items()))
    assert [m.sequence for m in heard['voltage']] == list(range(end))
    assert [m.voltage for m in heard['voltage']] == run.get('voltage', 'voltage')[:, 1].tolist()
    assert heard['progress']


def test_a_process_of_one_strut_hears_its_own_strut_only(start, probe):
    """Truth: decentralized control. What the process subscribes to and publishes, as the middleware knows it."""
    start(*STRUT, '/strut_2', sample_rate=200.0)
    names = [('strut_controller', '/strut_2'), ('strut_identifier', '/strut_2')]
    probe.wait(lambda: set(names) <= set(probe.node.get_node_names_and_namespaces()))

    def topics(kind):
        found = set()
        for name, namespace in names:
            listed = getattr(probe.node, f'get_{kind}_names_and_types_by_node')(name, namespace)
            found |= {topic for topic, types in listed if 'satvib_msgs' in types[0]}
        return found

    own = {'/schedule', '/strut_2/acceleration'}
    probe.wait(lambda: topics('subscriber') == own)  # voltage and model never leave the process
    assert topics('publisher') == {
        f'/strut_2/{name}'
        for name in ('voltage', 'controller_state', 'progress', 'identified_model')
    }


def test_a_strut_is_started_by_hand_and_ends_at_a_signal(start, probe):
    """Truth: the two nodes keep their services and parameters; a plant with a schedule is answered to the end."""
    from satvib_msgs.msg import IirParameters, Schedule, VcaVoltage

    plant = start('satvib_plant_sim', 'plant_sim', rig='paper_1dof')
    strut = start(
        *STRUT, '/strut_1', ('-p', 'strut_controller:law:=off'), sample_rate=200.0, lockstep=True
    )
    voltages = probe.collect(VcaVoltage, '/strut_1/voltage')
    models = probe.collect(IirParameters, '/strut_1/identified_model')
    plan = Schedule(
        sample_period=0.005, struts=['strut_1'], phases=[1, 2, 4], first_sequence=[0, 100, 300],
        end_sequence=400,
    )  # fmt: skip
    probe.publisher(Schedule, '/schedule').publish(plan)
    assert plant.wait() == 0, plant.said
    probe.wait(lambda: len(voltages) == 400)
    assert [m.sequence for m in models] == list(range(100, 300))
    assert models[-1].next_sequence == 2**63 - 1
    strut.send(signal.SIGTERM)
    assert strut.wait() == 0, strut.said


def test_in_real_time_states_are_fewer_and_voltages_are_not(tmp_path, domain):  # noqa: ARG001
    """Truth: state_period of 0.05 s at 100 Hz: every fifth sample, and those on which phase or reason change."""
    from satvib_experiment.scenario.scenario import load_scenario

    outcome, run = recorded(load_scenario('quick_3dof'), tmp_path / 'run', 'single', realtime=True)
    there = run.get('state', 'present')
    assert there[::5].all()
    assert there.mean() < 0.4
    assert run.get('voltage', 'present').all()
    assert run.get('truth', 'present').all()
    assert outcome.samples == len(run.sequence)
    # a state stays until the next
    rms = run.get('state', 'upper_rms')
    assert (rms[1][~there[1]] == rms[0][~there[1]]).all()


def test_single_is_interrupted_and_its_bag_is_readable(tmp_path, domain):  # noqa: ARG001
    """Truth: the promise of the README: soon, by name, with a bag that reads; one process, which goes on."""
    import threading

    from satvib_bringup.live.run import run_experiment
    from satvib_experiment.recording.bag_reader import read_recording
    from satvib_experiment.scenario.scenario import load_scenario

    cancel = threading.Event()
    scenario = load_scenario('paper_1dof_10hz').replace(duration=3000.0)
    outcome = run_experiment(
        scenario, tmp_path / 'run', progress=lambda _: cancel.set(), cancel=cancel,
        composition='single',
    )  # fmt: skip
    assert not outcome.success
    assert outcome.message.startswith('interrupted at sample ')
    assert len(read_recording(outcome.bag).sequence) >= outcome.samples > 0
