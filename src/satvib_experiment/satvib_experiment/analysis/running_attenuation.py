# SPDX-FileCopyrightText: 2026 The satvib authors
# SPDX-License-Identifier: Apache-2.0
"""Attenuation shown while a run goes on, from the running RMS that the controllers report (`upper_rms`).

    attenuation = 20 log10(running RMS now, in CONTROL / running RMS of the reference)

The reference is the last sample that was seen in STANDBY with the disturbance on. There is no attenuation outside of
CONTROL, and none without a reference. Live graph and offline twin both show this figure; the report has others, which
compare whole windows.
"""

from typing import Any

import numpy as np
from satvib_common.arrays import Array
from satvib_common.levels import decibel
from satvib_common.phases import Phase


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
