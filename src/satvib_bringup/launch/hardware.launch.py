# SPDX-FileCopyrightText: 2026 The satvib authors
# SPDX-License-Identifier: Apache-2.0
"""The graph on real hardware: `daq_bridge` in the place of the plant. Arm it with the service ~/arm.

    ros2 launch satvib_bringup hardware.launch.py channels:=my_rig.yaml scenario:=my_scenario.yaml record:=true
    ros2 launch satvib_bringup hardware.launch.py --show-args

What it starts: `satvib_bringup/live/launching/plans.py`.
"""

from launch import LaunchDescription
from satvib_bringup.live.launching.description import launch_description


def generate_launch_description() -> LaunchDescription:
    return launch_description('hardware')
