# SPDX-FileCopyrightText: 2026 The satvib authors
# SPDX-License-Identifier: Apache-2.0
"""How far the offline twin is, and the attenuation so far, for those who wait for it."""

from collections.abc import Callable

from satvib_common.arrays import Array
from satvib_common.phases import Phase

from satvib_experiment.analysis.running_attenuation import RunningAttenuation
from satvib_experiment.analysis.tones import disturbance_onset
from satvib_experiment.scenario.scenario import Scenario
from satvib_experiment.twin.step import LoopStep

Update = Callable[[Phase, float, Array], None]


class TwinProgress:
    """Follows the offline twin and reports the attenuation; called with every step.

    Args:
        scenario: what runs.
        update: called with phase, time in s and attenuation (struts,) in dB.
        interval: s of the run between calls; a change of phase is reported at once.
    """

    def __init__(self, scenario: Scenario, update: Update, interval: float = 0.25) -> None:
        self._period = 1.0 / scenario.load_rig().acquisition.sample_rate
        self._onset = disturbance_onset(scenario.make_disturbance())
        self._update = update
        self._every = max(round(interval / self._period), 1)
        self._phase: Phase | None = None
        self._running: RunningAttenuation | None = None

    def __call__(self, step: LoopStep) -> None:
        """Take a step."""
        level = step.output.upper_rms
        if self._running is None:
            self._running = RunningAttenuation(self._onset, self._period, len(level))
        self._running.add(step.sequence, step.phase, level)
        if step.phase is not self._phase or step.sequence % self._every == 0:
            self._phase = step.phase
            self._update(step.phase, step.sequence * self._period, self._running.decibels)
