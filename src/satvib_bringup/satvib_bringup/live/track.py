# SPDX-FileCopyrightText: 2026 The satvib authors
# SPDX-License-Identifier: Apache-2.0
"""How far a run is, from what its controllers report."""

import time
from typing import Any

from satvib_common.phases import Phase
from satvib_experiment.analysis.running_attenuation import RunningAttenuation

from satvib_bringup.live.graph import Graph
from satvib_bringup.live.progress import Progress


class Track:
    """The newest satvib_msgs/StrutProgress of each strut.

    Args:
        graph: what runs.
    """

    def __init__(self, graph: Graph) -> None:
        self.graph = graph
        self._newest: dict[str, Any] = {}
        self._attenuation = RunningAttenuation(graph.onset, graph.sample_period, len(graph.struts))
        self._began = time.monotonic()

    def begin(self) -> None:
        """The run begins now."""
        self._began = time.monotonic()

    def take(self, strut: str, message: Any) -> None:
        """Take what a strut reports."""
        self._newest[strut] = message

    def progress(self) -> Progress | None:
        """How far the run is; None before the first sample."""
        if not self._newest:
            return None
        for i, strut in enumerate(self.graph.struts):
            if (seen := self._newest.get(strut)) is not None:
                self._attenuation.add(int(seen.sequence), seen.phase, seen.upper_rms, i)
        newest = max(self._newest.values(), key=lambda seen: seen.sequence)
        samples = int(newest.sequence) + 1
        elapsed = max(time.monotonic() - self._began, 1e-9)
        return Progress(
            phase=Phase(newest.phase),
            sequence=int(newest.sequence),
            end=self.graph.plan.end,
            time=samples * self.graph.sample_period,
            attenuation=tuple(self._attenuation.decibels.tolist()),
            speed=samples * self.graph.sample_period / elapsed,
        )
