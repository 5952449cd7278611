# SPDX-FileCopyrightText: 2026 The satvib authors
# SPDX-License-Identifier: Apache-2.0
"""The experiment server with a real client."""

import signal
from pathlib import Path


def client(probe):
    from rclpy.action import ActionClient

    from satvib_msgs.action import RunExperiment

    made = ActionClient(probe.node, RunExperiment, '/run_experiment')
    probe.wait(made.server_is_ready)
    return made


def send(probe, made, feedback, **goal):
    from satvib_msgs.action import RunExperiment

    future = made.send_goal_async(
        RunExperiment.Goal(**goal), feedback_callback=lambda m: feedback.append(m.feedback)
    )
    probe.wait(future.done)
    return future.result()


def result_of(probe, handle):
    future = handle.get_result_async()
    probe.wait(future.done, limit=120.0)
    return future.result()


def test_a_goal_runs_and_is_reported(start, probe, tmp_path):
    """Truth: the files of a run and result.json; a second goal meanwhile is refused; a bad one names its fault."""
    import json

    from action_msgs.msg import GoalStatus

    start('satvib_bringup', 'experiment', runs=str(tmp_path / 'runs'))
    made, feedback = client(probe), []
    bad = result_of(probe, send(probe, made, feedback, scenario='quick_4dof'))
    assert bad.status == GoalStatus.STATUS_ABORTED
    assert 'quick_4dof' in bad.result.message
    handle = send(
        probe, made, feedback, scenario='quick_3dof', overrides=['seed=5', 'composition=single']
    )
    assert handle.accepted
    assert not send(probe, made, [], scenario='quick_3dof').accepted
    answer = result_of(probe, handle)
    assert answer.status == GoalStatus.STATUS_SUCCEEDED, answer.result.message
    folder = Path(answer.result.folder)
    assert folder == (tmp_path / 'runs' / 'quick_3dof-001').resolve()
    result = json.loads((folder / 'result.json').read_text())
    assert result['seed'] == 5
    for i, strut in enumerate(result['struts']):
        assert answer.result.struts[i] == strut['name']
        assert answer.result.true_tone[i] == strut['attenuation']['true_tone']
    assert feedback
    assert feedback[-1].sequence < 400


def test_a_goal_is_cancelled(start, probe, tmp_path):
    """Truth: the action's protocol. Cancelled, everything stopped, the bag is readable."""
    from action_msgs.msg import GoalStatus
    from satvib_experiment.recording.bag_reader import read_recording

    server = start('satvib_bringup', 'experiment')
    made, feedback = client(probe), []
    folder = tmp_path / 'run'
    handle = send(
        probe, made, feedback, scenario='paper_1dof_10hz', folder=str(folder), realtime=True
    )
    probe.wait(lambda: feedback and feedback[-1].sequence > 20)
    cancelling = handle.cancel_goal_async()
    answer = result_of(probe, handle)
    assert cancelling.result().goals_canceling
    assert answer.status == GoalStatus.STATUS_CANCELED, answer.result.message
    assert 'interrupted' in answer.result.message
    recording = read_recording(folder)
    assert recording.realtime
    assert len(recording.sequence) > 20
    server.send(signal.SIGTERM)
    assert server.wait() == 0, server.said
