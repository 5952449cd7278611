# SPDX-FileCopyrightText: 2026 The satvib authors
# SPDX-License-Identifier: Apache-2.0
"""Six struts as a live graph: the bits of the offline twin."""

import pytest

TONE = '{kind: sine, frequency: 7.0, amplitude: 0.3, start: 1.3, direction: [0.8, 0.3, 0.6]}'
WHEEL = '{kind: mounted_wheel, target: payload, start: 1.3, speed: 8.0, radial: [2.0e-4], torque: [2.0e-5]}'
SHAKE = f'disturbance={{kind: sum, terms: [{TONE}, {WHEEL}]}}'
PHASES = (
    '{phase: CALIBRATE}, {phase: IDENTIFY, start: 0.3}, {phase: STANDBY, start: 1.3}, '
    '{phase: CONTROL, start: 1.8}'
)
SHORT = ['duration=2.5', f'phases=[{PHASES}]', SHAKE, 'analysis={}']
CENTRAL = [
    'duration=1.5', 'phases=[{phase: CALIBRATE}, {phase: CONTROL, start: 0.5}]',
    SHAKE.replace('1.3', '0.5'), 'analysis={}',
]  # fmt: skip


def compared(name, changes, folder, composition):
    """What differs between a live run and the twin, and the live run."""
    from satvib_bringup.live.run import run_experiment
    from satvib_experiment.recording.bag_reader import read_recording
    from satvib_experiment.recording.recording import differences
    from satvib_experiment.scenario.scenario import load_scenario
    from satvib_experiment.twin.closed_loop import simulate

    scenario = load_scenario(name, changes)
    outcome = run_experiment(scenario, folder, composition=composition)
    assert outcome.success, outcome.message
    run = read_recording(outcome.bag)
    assert len(run.struts) == 6
    return differences(run, simulate(scenario)), run


def test_six_struts_equal_the_offline_twin(tmp_path, domain):  # noqa: ARG001
    """Truth: the offline twin, every bit of every field but those of the machine; every strut acts."""
    import numpy as np

    found, run = compared('hexapod_6dof', SHORT, tmp_path / 'run', 'single')
    assert found == []
    assert np.abs(run.get('voltage', 'voltage')[-100:]).max(axis=0).min() > 0.01


@pytest.mark.long
@pytest.mark.parametrize('composition', ['separate', 'strut'])
def test_six_struts_in_many_processes_equal_the_offline_twin(composition, tmp_path, domain):  # noqa: ARG001
    """Truth: the offline twin, every bit; fourteen processes, or eight."""
    assert compared('hexapod_6dof', SHORT, tmp_path / 'run', composition)[0] == []


def test_one_controller_for_six_motions_equals_the_offline_twin(tmp_path, domain):  # noqa: ARG001
    """Truth: the offline twin, every bit; its identifiers have nothing to hear."""
    found, run = compared('hexapod_6dof_centralized', CENTRAL, tmp_path / 'run', 'single')
    assert found == ['model: only one of them has it']
    assert set(run.get('state', 'law').ravel()) == {'centralized'}
