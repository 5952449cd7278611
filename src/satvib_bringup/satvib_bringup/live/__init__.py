# SPDX-FileCopyrightText: 2026 The satvib authors
# SPDX-License-Identifier: Apache-2.0
"""A scenario as a live graph of processes: described, started, watched, stopped."""

from typing import TYPE_CHECKING

from satvib_common.door import door

if TYPE_CHECKING:
    from satvib_bringup.live.discovery import Discovery
    from satvib_bringup.live.graph import Graph, graph_of
    from satvib_bringup.live.observer import Observer
    from satvib_bringup.live.process import NodeSpec, Process, Stage
    from satvib_bringup.live.progress import Outcome, Progress
    from satvib_bringup.live.run import run_experiment
    from satvib_bringup.live.supervisor import Supervisor

__all__ = [
    'Discovery',
    'Graph',
    'NodeSpec',
    'Observer',
    'Outcome',
    'Process',
    'Progress',
    'Stage',
    'Supervisor',
    'graph_of',
    'run_experiment',
]
__getattr__, __dir__ = door(__name__, __file__)
