# SPDX-FileCopyrightText: 2026 The satvib authors
# SPDX-License-Identifier: Apache-2.0
"""Live experiments: the graph of nodes, its recorder, and the command `satvib`."""

from typing import TYPE_CHECKING

from satvib_common.door import door

if TYPE_CHECKING:
    from satvib_bringup.live.graph import Graph, graph_of
    from satvib_bringup.live.progress import Outcome, Progress
    from satvib_bringup.live.run import run_experiment

__all__ = [
    'Graph',
    'Outcome',
    'Progress',
    'graph_of',
    'run_experiment',
]
__getattr__, __dir__ = door(__name__, __file__)
