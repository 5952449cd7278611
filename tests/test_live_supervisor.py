# SPDX-FileCopyrightText: 2026 The satvib authors
# SPDX-License-Identifier: Apache-2.0
"""The supervisor of a live graph, in the runner's process and as a process beside the others."""

import numpy as np
import pytest

PHASES = (
    'phases=[{phase: CALIBRATE}, {phase: IDENTIFY, start: 0.5}, {phase: STANDBY, start: 2.5},'
    ' {phase: CONTROL, start: 4.0}]'
)
REVERSED = (
    'failures=[{kind: rig_changed, time: 5.0, changes: {coil.force_scale: [1.0, -1.0, 1.0]}}]'
)


def run_as_the_twin(folder, composition, duration):
    """A run in which the coil of strut 2 is reversed in CONTROL, and the struts' own watches are off.

    Truth: the offline twin, bit for bit.
    """
    from satvib_bringup.live.run import run_experiment
    from satvib_experiment.recording.bag_reader import read_recording
    from satvib_experiment.recording.recording import differences
    from satvib_experiment.scenario.scenario import load_scenario
    from satvib_experiment.twin.closed_loop import simulate

    settings = [
        'name=live', f'duration={duration}', PHASES, REVERSED, 'supervisor=true', 'analysis={}',
        f'composition={composition}',
        'disturbance={kind: sine, frequency: 10.0, amplitude: 0.5, start: 2.5}',
        'controller={law: velocity_feedback, watch_loudness: 1000.0, excitation_amplitude: 2.0}',
    ]  # fmt: skip
    scenario = load_scenario('soft_3dof', settings)
    outcome = run_experiment(scenario, folder)
    assert outcome.success, outcome.message
    run = read_recording(outcome.bag)
    assert differences(run, simulate(scenario)) == []
    return run


def test_a_supervisor_beside_the_others_holds_the_strut_that_shakes_them(tmp_path, domain):  # noqa: ARG001
    """Truth: as above; the strut whose coil is reversed is the one that is held: 0 V, and the reason says from where.

    What comes later, that it is stopped, is below in one process, and of the long form beside the others.
    """
    run = run_as_the_twin(tmp_path / 'run', 'separate', 8.0)
    reasons = run.get('state', 'reason')[-1].tolist()
    assert reasons == ['', '0 V: held from outside, other struts are loud', '']
    assert not run.get('state', 'voltage')[-50:, 1].any()
    assert run.get('state', 'voltage')[-50:, [0, 2]].any(axis=0).all()


@pytest.mark.parametrize(
    'composition', ['single', pytest.param('separate', marks=pytest.mark.long)]
)
def test_it_stops_the_strut_that_shakes_the_others(composition, tmp_path, domain):  # noqa: ARG001
    """Truth: as above; the strut whose coil is reversed is the one that is stopped, through its service.

    0 V, and the reason says from where. The payload is then no louder than without control, within 6 dB.
    """
    from satvib_experiment.twin.closed_loop import simulate_open_loop

    run = run_as_the_twin(tmp_path / 'run', composition, 20.0)
    faults = run.get('state', 'fault')
    assert faults[-1].tolist() == [False, True, False]
    assert not run.get('state', 'voltage')[-100:, 1].any()
    assert run.get('state', 'reason')[-1, 1] == 'fault: stopped from outside'
    tail = run.window(19.0, 20.0)
    levels = [
        np.sqrt((r.get('truth', 'upper')[tail] ** 2).mean(axis=(0, 2)))
        for r in (run, simulate_open_loop(run))
    ]
    assert np.all(levels[0] < 2.0 * levels[1])
