# SPDX-FileCopyrightText: 2026 The satvib authors
# SPDX-License-Identifier: Apache-2.0
"""What every figure of a report is drawn from."""

from dataclasses import dataclass

import numpy as np
from satvib_common.arrays import Array
from satvib_common.phases import Phase

from satvib_experiment.analysis.evaluation import Evaluation
from satvib_experiment.recording.recording import Recording
from satvib_experiment.recording.signals import fine, without_bias
from satvib_experiment.report.comparison import Row


@dataclass(frozen=True)
class Context:
    """A run, its open-loop twin when there is one, its figures, and the runs that are shown beside it."""

    recording: Recording
    open_loop: Recording | None
    evaluation: Evaluation
    comparison: tuple[Row, ...] = ()

    @property
    def struts(self) -> tuple[str, ...]:
        """Names of the struts."""
        return self.recording.struts

    @property
    def has_truth(self) -> bool:
        """Whether it is known what happened between the samples."""
        return self.recording.has('truth', 'upper')

    def fine_time(self, window: slice = slice(None)) -> Array:
        """Time of the truth's fine samples, s."""
        count = self.recording.get('truth', 'upper').shape[2]
        start = self.recording.time[window]
        steps = np.arange(count) * self.recording.fine_period
        return np.asarray((start[:, None] + steps).ravel())

    def fine(self, window: slice = slice(None), plate: str = 'upper') -> Array:
        """Truth on the fine grid (samples, struts), m/s^2."""
        return fine(self.recording, window, plate)

    def measured(self, window: slice = slice(None)) -> Array:
        """Upper acceleration as sampled, without the bias of CALIBRATE (samples, struts), m/s^2."""
        return without_bias(self.recording, window)

    def span(self, phase: Phase) -> tuple[float, float] | None:
        """Start and end in s of the first phase of a kind, None when there is none."""
        for found, start, end in self.recording.phases():
            if found is phase:
                return start, end
        return None
