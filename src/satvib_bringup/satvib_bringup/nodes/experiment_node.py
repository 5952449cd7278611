# SPDX-FileCopyrightText: 2026 The satvib authors
# SPDX-License-Identifier: Apache-2.0
"""The node `experiment`: the action server `run_experiment`, one run at a time.

ros2 action send_goal --feedback /run_experiment satvib_msgs/action/RunExperiment "{scenario: quick_3dof}"
"""

from dataclasses import dataclass
from pathlib import Path
from typing import Any

from rclpy.action import ActionServer, CancelResponse, GoalResponse
from rclpy.action.server import ServerGoalHandle
from rclpy.task import Future
from satvib_common.ros.main import run_node
from satvib_common.ros.node import SatvibNode
from satvib_common.schema import Schema, param

from satvib_bringup.live.progress import Progress
from satvib_bringup.nodes.experiment_goal import KINDS, ExperimentGoal
from satvib_msgs.action import RunExperiment


@dataclass(frozen=True, kw_only=True)
class ExperimentParameters(Schema):
    """Where runs go."""

    runs: str = param('runs', 'folder in which every run gets a folder of its own')


class ExperimentNode(SatvibNode[ExperimentParameters]):
    """Runs experiments on request."""

    def __init__(self) -> None:
        super().__init__('experiment', ExperimentParameters)

    def configure(self) -> None:
        """Nothing runs yet."""
        self.goal: ExperimentGoal | None = None
        self.client: ServerGoalHandle | None = None
        self.over: Future = Future()
        self.reported: Progress | None = None

    def activate(self) -> None:
        """Offer the action."""
        self.server = ActionServer(
            self,
            RunExperiment,
            'run_experiment',
            execute_callback=self._execute,
            goal_callback=self._may_begin,
            cancel_callback=self._may_cancel,
        )

    def deactivate(self) -> None:
        """End a run that goes on, and leave nothing behind."""
        if self.goal is not None:
            self.goal.cancel()
            self.goal.join()
        self.server.destroy()

    def stop(self) -> str:
        """End the run."""
        if self.goal is None:
            return 'no run'
        self.goal.cancel()
        return 'the run is being stopped'

    def diagnose(self) -> tuple[str, dict[str, object]]:
        """Say whether a run goes on."""
        return '', {'running': self.goal is not None}

    def tick(self) -> float:
        """Publish the progress that the run's thread reports."""
        goal, client = self.goal, self.client
        if goal is None or client is None:
            return 0.1
        if goal.progress is not None and goal.progress is not self.reported:
            self.reported = goal.progress
            client.publish_feedback(_feedback(goal.progress))
        if goal.done() and not self.over.done():
            self.over.set_result(None)
        return 0.1

    def _may_begin(self, _request: Any) -> GoalResponse:
        if self.goal is not None:
            self.get_logger().warning('a run goes on already; goal refused')
            return GoalResponse.REJECT
        return GoalResponse.ACCEPT

    def _may_cancel(self, _handle: ServerGoalHandle) -> CancelResponse:
        if self.goal is None:
            return CancelResponse.REJECT
        self.goal.cancel()
        return CancelResponse.ACCEPT

    async def _execute(self, handle: ServerGoalHandle) -> RunExperiment.Result:
        request = handle.request
        self.over = Future()
        self.reported = None
        self.goal = goal = ExperimentGoal(
            request.scenario,
            request.overrides,
            request.realtime,
            request.folder,
            Path(self.parameters.runs),
        )
        self.client = handle
        await self.over
        goal.join()
        self.goal = self.client = None
        found = goal.result
        self.get_logger().info(found.message)
        result = RunExperiment.Result(
            success=found.success,
            message=found.message,
            folder=found.folder,
            struts=list(found.struts),
            **{kind: found.attenuation.get(kind, []) for kind in KINDS},
        )
        if found.success:
            handle.succeed()
        elif goal.cancelled and handle.is_cancel_requested:
            handle.canceled()
        else:
            handle.abort()
        return result


def _feedback(progress: Progress) -> RunExperiment.Feedback:
    return RunExperiment.Feedback(
        phase=int(progress.phase),
        sequence=progress.sequence,
        time=progress.time,
        attenuation=list(progress.attenuation),
    )


def main() -> None:
    """Run the node."""
    run_node(ExperimentNode)


if __name__ == '__main__':
    main()
