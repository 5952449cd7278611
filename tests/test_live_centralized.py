# SPDX-FileCopyrightText: 2026 The satvib authors
# SPDX-License-Identifier: Apache-2.0
"""The centralized scheme as a live graph: one controller in the place of three."""

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
