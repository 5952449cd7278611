# SPDX-FileCopyrightText: 2026 The satvib authors
# SPDX-License-Identifier: Apache-2.0
"""Attenuation shown while a run goes on, from the running RMS that the controllers report (`upper_rms`).

    attenuation = 20 log10(running RMS now, in CONTROL / running RMS of the reference)

The reference is the last sample that was seen in STANDBY with the disturbance on. There is no attenuation outside of
CONTROL, and none without a reference. Live graph and offline twin both show this figure; the report has others, which
compare whole windows.
"""

from collections.abc import Callable
from typing import Any

import numpy as np
from satvib_common.arrays import Array
from satvib_common.levels import decibel
from satvib_common.phases import Phase

from satvib_experiment.analysis.tones import disturbance_onset
from satvib_experiment.scenario.scenario import Scenario
from satvib_experiment.twin.step import LoopStep

Update = Callable[[Phase, float, Array], None]


class RunningAttenuation:
    """The figure of every strut.

    Args:
        onset: s, when the disturbance begins.
        sample_period: s.
        struts: how many.
    """

    def __init__(self, onset: float, sample_period: float, struts: int) -> None:
        self._first = round(onset / sample_period)
        self._reference = np.full(struts, np.nan)
        self._level = np.full(struts, np.nan)

    def add(self, sequence: int, phase: int, upper_rms: Any, struts: Any = slice(None)) -> None:
        """Take a sample.

        Args:
            sequence: index of the sample.
            phase: of the sample.
            upper_rms: running RMS in m/s^2, of the struts that `struts` picks.
            struts: index of one strut, or a slice; all if not given.
        """
        if phase == Phase.STANDBY and sequence >= self._first:
            self._reference[struts] = upper_rms
        self._level[struts] = upper_rms if phase == Phase.CONTROL else np.nan

    @property
    def decibels(self) -> Array:
        """Attenuation (struts,) in dB, negative is better; NaN where there is none."""
        return decibel(self._level, self._reference)


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
