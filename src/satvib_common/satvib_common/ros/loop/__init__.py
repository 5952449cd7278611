# SPDX-FileCopyrightText: 2026 The satvib authors
# SPDX-License-Identifier: Apache-2.0
"""What the nodes of the loop share besides their base: what the coils got, who else is there, and what is awaited."""

from typing import TYPE_CHECKING

from satvib_common.door import door

if TYPE_CHECKING:
    from satvib_common.ros.loop.applied_block import AppliedBlocks
    from satvib_common.ros.loop.pace import PaceFollower
    from satvib_common.ros.loop.rivals import node_of, too_many_writers, two_sources, writers_of

__all__ = [
    'AppliedBlocks',
    'PaceFollower',
    'node_of',
    'too_many_writers',
    'two_sources',
    'writers_of',
]
__getattr__, __dir__ = door(__name__, __file__)
