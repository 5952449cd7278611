# SPDX-FileCopyrightText: 2026 The satvib authors
# SPDX-License-Identifier: Apache-2.0
"""One controller for all struts, from the same description as `satvib run`.

    ros2 launch satvib_bringup centralized.launch.py scenario:=paper_3dof_centralized
    ros2 launch satvib_bringup centralized.launch.py --show-args

What it starts: `satvib_bringup/live/launching/plans.py`.
"""

from launch import LaunchDescription
from satvib_bringup.live.launching.description import launch_description


def generate_launch_description() -> LaunchDescription:
    return launch_description('centralized')
