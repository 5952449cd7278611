# SPDX-FileCopyrightText: 2026 The satvib authors
# SPDX-License-Identifier: Apache-2.0
"""The voltages at the coils in real time: what arrived, when, and what happens when nothing arrives.

A voltage is in force from its arrival until the next one (zero-order hold). A strut whose controller has answered once
and is then silent for longer than the timeout is ramped to 0 V in a straight line over that same time, and stays
there until `reset`. The same happens to a strut that gets a voltage which is not a number, and to all at `stop`.

Times are s on any steady clock, given by the caller.
"""

import math

import numpy as np
from satvib_common.arrays import Array
from satvib_common.guard import towards_zero

_NEVER = -math.inf


class Commands:
    """The command of each strut.

    Args:
        struts: how many.
        timeout: s, longest silence.
        period: s, sample period.
    """

    def __init__(self, struts: int, timeout: float, period: float) -> None:
        self.timeout, self.period = timeout, period
        self.late = 0
        self.fault = np.zeros(struts, dtype=bool)
        self._wanted = np.zeros(struts)
        self._voltage = np.zeros(struts)
        self._ramp = np.zeros(struts)
        self._last_time = np.full(struts, _NEVER)
        self._arrival = np.zeros(struts)

    def take(
        self, strut_index: int, voltage: float, now: float, since_sample: float, late: bool
    ) -> None:
        """Take a voltage for one strut.

        Args:
            strut_index: from 0.
            voltage: V.
            now: s.
            since_sample: s since the sample whose period this is.
            late: the voltage answers an older sample.
        """
        self._last_time[strut_index] = now
        self.late += late
        if not math.isfinite(voltage):
            self.latch(strut_index)
        elif not self.fault[strut_index]:
            self._wanted[strut_index] = voltage
            self._arrival[strut_index] = since_sample

    def latch(self, strut: int | slice = slice(None)) -> None:
        """Begin the way to 0 V."""
        fresh = ~self.fault[strut]
        self.fault[strut] = True
        step = np.abs(self._wanted[strut]) * self.period / max(self.timeout, self.period)
        self._ramp[strut] = np.where(fresh, step, self._ramp[strut])

    def reset(self) -> None:
        """Release the faults; the next voltage counts again."""
        self.fault[:] = False
        self._last_time[:] = _NEVER
        self._wanted[:] = 0.0

    def period_over(self, now: float) -> tuple[Array, Array]:
        """Give what the period that ends now has seen: voltages (struts) and their arrivals (struts, s)."""
        silent = (now - self._last_time > self.timeout) & (self._last_time > _NEVER)
        for strut in np.flatnonzero(silent & ~self.fault):
            self.latch(int(strut))
        ramped = towards_zero(self._voltage, self._ramp)
        self._voltage = np.where(self.fault, ramped, self._wanted)
        self._wanted = np.where(self.fault, self._voltage, self._wanted)
        arrival, self._arrival = self._arrival, np.zeros_like(self._arrival)
        return self._voltage, arrival
