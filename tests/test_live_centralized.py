# SPDX-FileCopyrightText: 2026 The satvib authors
# SPDX-License-Identifier: Apache-2.0
"""The centralized scheme as a live graph, one controller in the place of three; and matrices as parameters."""

import numpy as np
import pytest

SETTINGS = [
    'name=centralized',
    'scheme=centralized',
    'centralized.gains_p=[56.0, 50.0, 45.0]',
    'centralized.gains_i=[100.0, 0.0, 0.0]',
    'centralized.gains_d=[0.2, 0.1, 0.1]',
    'duration=4.0',
    'phases.2.start=1.5',
    'phases.3.start=2.0',
    'disturbance.start=1.5',
    'analysis.uncontrolled=[1.6, 2.0]',
    'analysis.controlled=[3.0, 4.0]',
]


def test_one_controller_for_all_equals_the_offline_twin(tmp_path, domain):  # noqa: ARG001
    """Truth: the offline twin, every bit of every field but those of the machine."""
    from satvib_bringup.live.run import run_experiment
    from satvib_experiment.recording.bag_reader import read_recording
    from satvib_experiment.recording.recording import differences
    from satvib_experiment.scenario.scenario import load_scenario
    from satvib_experiment.twin.closed_loop import simulate

    scenario = load_scenario('soft_3dof', SETTINGS)
    outcome = run_experiment(scenario, tmp_path / 'run')
    assert outcome.success, outcome.message
    run = read_recording(outcome.bag)
    assert differences(run, simulate(scenario)) == []
    assert set(run.get('state', 'law').ravel()) == {'centralized'}
    logs = sorted(p.name for p in (tmp_path / 'run' / 'logs').iterdir())
    assert 'centralized_controller.log' in logs
    assert not [name for name in logs if 'strut_controller' in name]


FIXED = {
    'lqg': (
        ['scheme=centralized', 'centralized={}', 'controller={}'],
        'centralized.file',
        'lqg.yaml',
    ),
    'notch': (['controller={law: state_space}'], 'controller.file', 'notch.yaml'),
}


@pytest.mark.parametrize('name', FIXED)
def test_matrices_in_parameters_equal_the_offline_twin(name, tmp_path, domain):  # noqa: ARG001
    """Truth: the offline twin, every bit; the matrices are parameters of the nodes, of all struts and of each strut."""
    from satvib_bringup.live.run import run_experiment
    from satvib_experiment.recording.bag_reader import read_recording
    from satvib_experiment.recording.recording import differences
    from satvib_experiment.scenario.scenario import load_scenario
    from satvib_experiment.twin.closed_loop import simulate
    from satvib_studies.comparison.cases import FILE

    scheme, key, file = FIXED[name]
    kept = [text for text in SETTINGS if 'centralized' not in text]
    changes = [f'name={name}', *kept, *scheme, f'{key}={FILE.parent / file}']
    scenario = load_scenario('soft_3dof', changes)
    outcome = run_experiment(scenario, tmp_path / 'run', composition='single')
    assert outcome.success, outcome.message
    run = read_recording(outcome.bag)
    assert differences(run, simulate(scenario)) == []
    assert set(run.get('state', 'law').ravel()) == {'state_space'}
    assert np.abs(run.get('voltage', 'voltage')[run.window(3.0, 4.0)]).max() > 0.1
