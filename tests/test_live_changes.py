# SPDX-FileCopyrightText: 2026 The satvib authors
# SPDX-License-Identifier: Apache-2.0
"""A drawn change of the rig in CONTROL, live: the short form of benchmarks/changes_live.py."""


def test_a_drawn_change_is_the_same_live(tmp_path, domain):  # noqa: ARG001
    """The coil of strut 2 is reversed in CONTROL: its watch pauses and strikes. Truth: the twin, bit for bit."""
    from satvib_bringup.live.run import run_experiment
    from satvib_experiment.recording.bag_reader import read_recording
    from satvib_experiment.recording.recording import differences
    from satvib_experiment.scenario.scenario import AnalysisSettings
    from satvib_experiment.twin.closed_loop import simulate
    from satvib_plant_sim.rig.rig import load_rig
    from satvib_studies.changes.drawing import draw_change
    from satvib_studies.changes.runs import scenario_of

    rig = load_rig('soft_3dof')
    change = draw_change(rig, 48, ('reversed_force',))
    scenario = scenario_of('soft_3dof', 'velocity_feedback', change, 48).replace(
        duration=12.5, composition='single', analysis=AnalysisSettings()
    )
    outcome = run_experiment(scenario, tmp_path / 'run', composition='single')
    assert outcome.success, outcome.message
    run = read_recording(outcome.bag)
    assert differences(run, simulate(scenario)) == []
    reasons = set(run.get('state', 'reason').ravel().tolist())
    assert any('listening whether the law is the cause' in reason for reason in reasons)
