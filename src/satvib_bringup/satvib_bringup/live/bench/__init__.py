# SPDX-FileCopyrightText: 2026 The satvib authors
# SPDX-License-Identifier: Apache-2.0
"""How fast the live graph is on this machine, against a graph of the same shape without any mathematics."""

from typing import TYPE_CHECKING

from satvib_common.door import door

if TYPE_CHECKING:
    from satvib_bringup.live.bench.case import Case, Figures, quick_cases, whole_cases
    from satvib_bringup.live.bench.run import bench
    from satvib_bringup.live.bench.table import markdown

__all__ = [
    'Case',
    'Figures',
    'bench',
    'markdown',
    'quick_cases',
    'whole_cases',
]
__getattr__, __dir__ = door(__name__, __file__)
