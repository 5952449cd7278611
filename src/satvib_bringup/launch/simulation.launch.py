# SPDX-FileCopyrightText: 2026 The satvib authors
# SPDX-License-Identifier: Apache-2.0
"""The live graph of a scenario, from the same description as `satvib run`.

    ros2 launch satvib_bringup simulation.launch.py scenario:=paper_3dof bag:=my_bag
    ros2 launch satvib_bringup simulation.launch.py --show-args

What it starts: `satvib_bringup/live/launching/plans.py`.
"""

from launch import LaunchDescription
from satvib_bringup.live.launching.description import launch_description


def generate_launch_description() -> LaunchDescription:
    return launch_description('simulation')
