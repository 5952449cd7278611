# SPDX-FileCopyrightText: 2026 The satvib authors
# SPDX-License-Identifier: Apache-2.0
"""A measured record, identified live.

    ros2 launch satvib_bringup replay.launch.py file:=record.csv input:=torque output:=acceleration
    ros2 launch satvib_bringup replay.launch.py --show-args

What it starts: `satvib_bringup/live/launching/plans.py`.
"""

from launch import LaunchDescription
from satvib_bringup.live.launching.description import launch_description


def generate_launch_description() -> LaunchDescription:
    return launch_description('replay')
