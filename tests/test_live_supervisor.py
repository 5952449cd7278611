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


def test_one_message_of_a_stranger_makes_it_forget_nothing(start, probe):
    """A sample 0 and a plan of another rate, in a run without end, whose sensors read 9.81 m/s^2 at rest.

    Truth: who has no base takes the bias for vibration, and holds the struts one by one; it must ask for nothing, for
    nothing has changed. What it judges goes on.
    """
    from satvib_common.phases import Phase
    from satvib_common.ros.qos import offered
    from std_msgs.msg import UInt64

    from satvib_msgs.msg import Schedule, StrutAcceleration, VcaVoltage

    process = start('satvib_control', 'supervisor', struts=2, sample_rate=100.0)
    judged = probe.collect(UInt64, '/supervision')
    plan = probe.publisher(Schedule, '/schedule')
    outs = [
        (
            probe.node.create_publisher(StrutAcceleration, f'/strut_{i}/acceleration', offered()),
            probe.node.create_publisher(VcaVoltage, f'/strut_{i}/voltage', offered()),
        )
        for i in (1, 2)
    ]
    every = [plan, *(out for both in outs for out in both)]
    probe.wait(lambda: all(out.get_subscription_count() for out in every))

    def said(period):
        plan.publish(
            Schedule(
                sample_period=period, struts=['strut_1', 'strut_2'],
                phases=[Phase.CALIBRATE, Phase.CONTROL], first_sequence=[0, 100],
            )
        )  # fmt: skip

    def samples(first, end):
        for k in range(first, end):
            shaken = 0.1 * np.sin(2.0 * np.pi * 7.3 * k / 100.0)
            for acceleration, voltage in outs:
                acceleration.publish(StrutAcceleration(sequence=k, upper=9.81 + shaken))
                voltage.publish(VcaVoltage(sequence=k, voltage=shaken))
        probe.wait(lambda: judged and judged[-1].data == end - 1)

    said(0.01)
    samples(0, 200)
    said(0.02)
    outs[0][0].publish(StrutAcceleration(sequence=0, upper=9.81))
    samples(200, 800)
    probe.wait(lambda: 'refused: schedule: sample_period is 0.02 s' in process.said)
    assert 'hold' not in process.said
