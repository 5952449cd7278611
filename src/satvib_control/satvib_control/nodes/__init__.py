# SPDX-FileCopyrightText: 2026 The satvib authors
# SPDX-License-Identifier: Apache-2.0
"""The nodes `strut_controller`, `centralized_controller` and `supervisor`: messages in, messages out."""

from typing import TYPE_CHECKING

from satvib_common.door import door

if TYPE_CHECKING:
    from satvib_control.nodes.centralized_controller_node import CentralizedControllerNode
    from satvib_control.nodes.controller_node import ControllerNode
    from satvib_control.nodes.model_queue import ModelQueue
    from satvib_control.nodes.sample_gatherer import SampleGatherer
    from satvib_control.nodes.strut_controller_node import StrutControllerNode
    from satvib_control.nodes.supervisor_node import SupervisorNode

__all__ = [
    'CentralizedControllerNode',
    'ControllerNode',
    'ModelQueue',
    'SampleGatherer',
    'StrutControllerNode',
    'SupervisorNode',
]
__getattr__, __dir__ = door(__name__, __file__)
