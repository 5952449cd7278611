# SPDX-FileCopyrightText: 2026 The satvib authors
# SPDX-License-Identifier: Apache-2.0
"""`satvib watch`: a local web page of a running graph."""

from typing import TYPE_CHECKING

from satvib_common.door import door

if TYPE_CHECKING:
    from satvib_bringup.watch.graph import WatchedGraph
    from satvib_bringup.watch.samples import Column, SampleRing
    from satvib_bringup.watch.strut import WatchedStrut

__all__ = [
    'Column',
    'SampleRing',
    'WatchedGraph',
    'WatchedStrut',
]
__getattr__, __dir__ = door(__name__, __file__)
