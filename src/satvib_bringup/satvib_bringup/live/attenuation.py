# SPDX-FileCopyrightText: 2026 The satvib authors
# SPDX-License-Identifier: Apache-2.0
"""Attenuation while a run goes on: the running RMS against its level with the disturbance and without control."""

from collections.abc import Callable
from typing import TYPE_CHECKING

import numpy as np
from satvib_common.arrays import Array
from satvib_common.levels import decibel
from satvib_common.phases import Phase
from satvib_experiment.analysis.tones import disturbance_onset
from satvib_experiment.scenario.scenario import Scenario

if TYPE_CHECKING:
    from satvib_experiment.twin.step import LoopStep

Update = Callable[[Phase, float, Array], None]


class LiveAttenuation:
    """Follows a run and tells now and then how it stands.

    Args:
        scenario: what runs.
        update: called with phase, time in s and attenuation (struts,) in dB.
        interval: s of the run between calls; a change of phase is told at once.
    """

    def __init__(self, scenario: Scenario, update: Update, interval: float = 0.25) -> None:
        self.rate = scenario.load_rig().acquisition.sample_rate
        self._onset = disturbance_onset(scenario.make_disturbance())
        self._update = update
        self._every = max(round(interval * self.rate), 1)
        self._phase: Phase | None = None
        self._level: Array | None = None

    def see(self, sequence: int, phase: Phase, upper_rms: Array) -> None:
        """Take one sample's phase and running RMS (struts,)."""
        now = sequence / self.rate
        if phase is Phase.STANDBY and now >= self._onset:
            self._level = upper_rms
        if phase is not self._phase or sequence % self._every == 0:
            self._phase = phase
            known = self._level is not None
            base = self._level if self._level is not None else np.zeros_like(upper_rms)
            self._update(phase, now, decibel(upper_rms, base) if known else base * np.nan)

    def __call__(self, step: 'LoopStep') -> None:
        """Take a step of the offline twin."""
        self.see(step.sequence, step.phase, step.output.upper_rms)
