# SPDX-FileCopyrightText: 2026 The satvib authors
# SPDX-License-Identifier: Apache-2.0
"""Controller and identifier of one strut, as on a module of the rig.

    ros2 launch satvib_bringup strut.launch.py strut:=strut_1 realtime:=true
    ros2 launch satvib_bringup strut.launch.py --show-args

What it starts: `satvib_bringup/live/launching/plans.py`.
"""

from launch import LaunchDescription
from satvib_bringup.live.launching.description import launch_description


def generate_launch_description() -> LaunchDescription:
    return launch_description('strut')
