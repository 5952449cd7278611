# SPDX-FileCopyrightText: 2026 The satvib authors
# SPDX-License-Identifier: Apache-2.0
"""Under which enclave of a keystore a process of a graph runs; without SROS2 there is none."""

import os

# of the runner, or of the node `schedule` of a launch: who begins a run
RUNNER, SCHEDULE = 'runner', 'schedule'
# of people's tools: ros2 topic, rqt, `satvib topics`, `satvib watch`
TOOLS = 'tools'


def enclave_arguments(full_name: str) -> list[str]:
    """Give what follows `--ros-args` for a process, as `strut_1/strut_controller`; nothing unless SROS2 is switched on.

    A variable of ROS that names an enclave for all processes wins, as it does in ROS.
    """
    on = os.environ.get('ROS_SECURITY_ENABLE') == 'true'
    if not on or os.environ.get('ROS_SECURITY_ENCLAVE_OVERRIDE'):
        return []
    return ['--enclave', f'/{full_name}']
