# SPDX-FileCopyrightText: 2026 The satvib authors
# SPDX-License-Identifier: Apache-2.0
"""The recorder alone, for a graph that is running.

    ros2 launch satvib_bringup record.launch.py bag:=my_bag
    ros2 launch satvib_bringup record.launch.py --show-args

What it starts: `satvib_bringup/live/launching/plans.py`.
"""

from launch import LaunchDescription
from satvib_bringup.live.launching.description import launch_description


def generate_launch_description() -> LaunchDescription:
    return launch_description('record')
