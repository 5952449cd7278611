# SPDX-FileCopyrightText: 2026 The satvib authors
# SPDX-License-Identifier: Apache-2.0
"""The nodes `experiment`, `recorder`, `replay` and `schedule`."""

from typing import TYPE_CHECKING

from satvib_common.door import door

if TYPE_CHECKING:
    from satvib_bringup.nodes.experiment_node import ExperimentNode
    from satvib_bringup.nodes.recorder_node import RecorderNode
    from satvib_bringup.nodes.replay_node import ReplayNode
    from satvib_bringup.nodes.schedule_node import ScheduleNode

__all__ = [
    'ExperimentNode',
    'RecorderNode',
    'ReplayNode',
    'ScheduleNode',
]
__getattr__, __dir__ = door(__name__, __file__)
