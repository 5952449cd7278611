# SPDX-FileCopyrightText: 2026 The satvib authors
# SPDX-License-Identifier: Apache-2.0
"""Topics of a running graph for people who have no `ros2` command: list, rate, echo."""

from typing import TYPE_CHECKING

from satvib_common.door import door

if TYPE_CHECKING:
    from satvib_bringup.live.topics.listener import Listener, Rate, TopicRow
    from satvib_bringup.live.topics.readable import text_of
    from satvib_bringup.live.topics.visitor import Visitor

__all__ = ['Listener', 'Rate', 'TopicRow', 'Visitor', 'text_of']
__getattr__, __dir__ = door(__name__, __file__)
