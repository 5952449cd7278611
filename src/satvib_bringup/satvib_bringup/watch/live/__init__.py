# SPDX-FileCopyrightText: 2026 The satvib authors
# SPDX-License-Identifier: Apache-2.0
"""What `satvib watch` hears of a running graph and asks of it."""

from typing import TYPE_CHECKING

from satvib_common.door import door

if TYPE_CHECKING:
    from satvib_bringup.watch.live.listener import GraphListener
    from satvib_bringup.watch.live.process import watch

__all__ = [
    'GraphListener',
    'watch',
]
__getattr__, __dir__ = door(__name__, __file__)
