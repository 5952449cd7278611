# SPDX-FileCopyrightText: 2026 The satvib authors
# SPDX-License-Identifier: Apache-2.0
"""Sensors that clip in a run: marks, laws and identifiers of the live graph are those of the twin."""

import numpy as np

PHASES = (
    'phases=[{phase: CALIBRATE}, {phase: IDENTIFY, start: 0.5}, {phase: STANDBY, start: 2.0},'
    ' {phase: CONTROL, start: 2.5}]'
)
FAILURES = (
    'failures=[{kind: rig_changed, time: 3.0, changes: {accelerometer.range: 12.0}},'
    ' {kind: rig_changed, time: 4.0, changes: {accelerometer.range: 39.2266}}]'
)
# the disturbance stays inside 4 g; for a second the range is less
SETTINGS = [
    'name=clipping',
    'duration=5',
    PHASES,
    'disturbance={kind: sine, frequency: 10.0, amplitude: 20.0, start: 1.0}',
    FAILURES,
    'controller={law: velocity_feedback, watch_loudness: 1000.0}',
    'analysis={}',
]


def test_clipped_samples_live_and_in_the_twin(tmp_path, domain):  # noqa: ARG001
    """Truth: the offline twin, bit for bit. The law is taken off while the range is too small."""
    from satvib_bringup.live.run import run_experiment
    from satvib_experiment.recording.bag_reader import read_recording
    from satvib_experiment.recording.recording import differences
    from satvib_experiment.scenario.scenario import load_scenario
    from satvib_experiment.twin.closed_loop import simulate

    scenario = load_scenario('paper_3dof', SETTINGS)
    outcome = run_experiment(scenario, tmp_path / 'run', composition='single')
    assert outcome.success, outcome.message
    run = read_recording(outcome.bag)
    assert differences(run, simulate(scenario)) == []
    clipped = run.get('acceleration', 'upper_clipped')
    inside = run.window(3.0, 4.0)
    assert clipped[inside].any(axis=0).all()
    assert not clipped[: inside.start].any()
    assert not clipped[inside.stop :].any()
    reasons = run.get('state', 'reason')[run.window(3.8, 3.9)]
    assert {str(text) for text in reasons.ravel()} == {
        '0 V: the upper sensor clips, so it cannot tell what the law does'
    }
    assert np.abs(run.get('voltage', 'voltage')[run.window(3.8, 3.9)]).max() == 0.0
