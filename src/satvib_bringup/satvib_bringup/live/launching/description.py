# SPDX-FileCopyrightText: 2026 The satvib authors
# SPDX-License-Identifier: Apache-2.0
"""A plan as a launch description: its arguments, its processes, and their common end.

When the member that ends the launch has ended well, the others are stopped stage by stage, writers before readers, so
that a recorder has all that was said. When any other member ends, or ends badly, the launch ends with its name and with
exit code 1.
"""

import os
import signal
from typing import Any

from launch import LaunchContext, LaunchDescription
from launch.actions import DeclareLaunchArgument, EmitEvent, OpaqueFunction, RegisterEventHandler
from launch.event_handlers import OnProcessExit
from launch.events import Shutdown, matches_action
from launch.events.process import ProcessExited, SignalProcess
from launch.substitutions import LaunchConfiguration
from launch_ros.actions import Node
from satvib_common.errors import RunError

from satvib_bringup.live.launching.member import Member
from satvib_bringup.live.launching.plans import PLANS, Plan
from satvib_bringup.live.security.enclaves import RUNNER, SCHEDULE, enclave_arguments
from satvib_bringup.live.supervisor import Exit
from satvib_bringup.live.workspace import graph_environment

_PATIENCE = '15.0'  # s, from SIGINT to SIGTERM; a recorder may have much to write


def launch_description(name: str) -> LaunchDescription:
    """Give the description of the launch file of that name."""
    plan = PLANS[name]
    declared = [
        DeclareLaunchArgument(argument, default_value=default, description=text)
        for argument, (default, text) in plan.arguments.items()
    ]
    return LaunchDescription([*declared, OpaqueFunction(function=_start, args=[plan])])


def _start(context: LaunchContext, plan: Plan) -> list[Any]:
    values = {name: LaunchConfiguration(name).perform(context) for name in plan.arguments}
    members = plan.placed_members(values)
    environment = {k: v for k, v in graph_environment().items() if os.environ.get(k) != v}
    actions = {_action(member, environment): member for member in members}
    return [RegisterEventHandler(OnProcessExit(on_exit=_End(actions))), *actions]


def _action(member: Member, environment: dict[str, str]) -> Node:
    named = {'name': member.name} if member.name else {}
    return Node(
        package=member.package,
        executable=member.executable,
        namespace=member.namespace,
        arguments=list(member.arguments),
        ros_arguments=[*member.ros_arguments, *enclave_arguments(_enclave(member))],
        additional_env=environment,
        output='screen',
        sigterm_timeout=_PATIENCE,
        **named,
    )


def _enclave(member: Member) -> str:
    """The node `schedule` begins the run, as the runner does elsewhere."""
    return RUNNER if member.executable == SCHEDULE else member.full_name


class _End:
    """Decides what the end of a member means."""

    def __init__(self, members: dict[Node, Member]) -> None:
        self._alive = members
        self._asked: set[Node] = set()
        self._in_order = False

    def __call__(self, event: ProcessExited, context: LaunchContext) -> list[Any] | None:
        member = self._alive.pop(event.action, None)
        if member is None or context.is_shutdown:
            return None
        if event.returncode != 0 or not (member.ends or event.action in self._asked):
            # launch gives exit code 1 for an error, and for nothing else
            raise RunError(
                f'{Exit(member.full_name, event.returncode, "")}, and so does the launch'
            )
        self._in_order = self._in_order or member.ends
        return self._next(member.full_name)

    def _next(self, name: str) -> list[Any]:
        if not self._alive:
            return [EmitEvent(event=Shutdown(reason=f'{name} has ended'))]
        stage = min(member.stage for member in self._alive.values())
        waiting = [a for a, m in self._alive.items() if m.stage == stage and a not in self._asked]
        self._asked.update(waiting)
        return [
            EmitEvent(
                event=SignalProcess(
                    signal_number=signal.SIGINT, process_matcher=matches_action(action)
                )
            )
            for action in waiting
        ]
