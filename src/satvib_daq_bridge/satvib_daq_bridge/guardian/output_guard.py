# SPDX-FileCopyrightText: 2026 The satvib authors
# SPDX-License-Identifier: Apache-2.0
"""The output guard: the one path from a demand to the terminals, for every back end.

In this order: 0 V in every state but ACTIVE; a demand that is not finite, or older than `max_age`, is a fault; slew
limit and clamp at the coil (`VoltageGuard`); I^2 t on the estimated current; the amplifier's gain; clamp and quantize
at the converter. A fault of any channel latches 0 V at all of them until `reset`.

The converter rounds to the nearest code that keeps both limits, and what it really gives is where the next slew begins:
so limit and slew hold at the terminals, not only before the rounding.
"""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from satvib_common.arrays import Array, Mask
from satvib_common.guard import VoltageGuard

from satvib_daq_bridge.channels import CoilChannel
from satvib_daq_bridge.guardian.coil_load import CoilLoad
from satvib_daq_bridge.states import State

# relative; a rounding error of the arithmetic is no violation
_EPSILON = 1e-12


@dataclass(frozen=True)
class Output:
    """What leaves.

    Attributes:
        coil: (outputs) V at the coils.
        converter: (outputs) V at the converters' terminals.
        saturated: (outputs) a limit or the slew limit changed the demand.
        fault: why all are at 0 V; empty when there is no fault.
    """

    coil: Array
    converter: Array
    saturated: Mask
    fault: str


class OutputGuard:
    """Guards all outputs of a bridge, in the order of `Channels.outputs`.

    Args:
        outputs: names and channels.
        period: s, sample period; the slew limit never allows more than one period's worth at once.
        max_age: s, oldest command that may act.
    """

    def __init__(
        self, outputs: Sequence[tuple[str, CoilChannel]], period: float, max_age: float
    ) -> None:
        self.names = [name for name, _ in outputs]
        coils = [coil for _, coil in outputs]
        self.period, self.max_age = period, max_age
        count = len(coils)
        # from volts at the coil to volts at the converter
        self._ratio = np.array([c.polarity / c.gain for c in coils])
        self._step = np.array([c.step for c in coils])
        ranges = np.array([c.range for c in coils]).reshape(-1, 2)
        # the ends of the range as codes counted from 0 V; the uppermost code is one step below the end
        grid = np.where(self._step > 0.0, self._step, 1.0)
        exact = self._step == 0.0
        self._low = np.where(exact, ranges[:, 0], np.ceil(ranges[:, 0] / grid) * grid)
        self._high = np.where(exact, ranges[:, 1], np.ceil(ranges[:, 1] / grid - 1.0) * grid)
        self._slew = np.array([c.slew for c in coils])
        limit = np.array([c.limit for c in coils])
        self._guard = VoltageGuard(limit, self._slew, period, (count,))
        self._load = CoilLoad(coils)
        self._demand_zero = np.zeros(count)
        self._clear = np.zeros(count, dtype=bool)
        self.fault = ''

    @property
    def coil(self) -> Array:
        """Voltages at the coils now (outputs)."""
        return self._guard.voltage

    @property
    def load(self) -> Array:
        """Thermal load of the coils (outputs); 1 is the most that may last."""
        return self._load.load

    def apply(
        self, demand: Array, age: Array, state: State, elapsed: float | None = None
    ) -> Output:
        """Limit demands and give what leaves.

        Args:
            demand: (outputs) V at the coils.
            age: (outputs) s, time since the sample that each demand answers.
            state: of the bridge.
            elapsed: s since the call before; None: one period.
        """
        time = self.period if elapsed is None else elapsed
        self._load.advance(self.coil, max(time, 0.0))
        if state is not State.ACTIVE:
            return self.zero()
        self._check(demand, age)
        if self.fault:
            return self.zero()
        before = self._guard.voltage
        self._guard.step = self._slew * min(max(time, 0.0), self.period)
        limited = self._guard.apply(demand).voltage
        coil = self._guard.voltage = self._quantized(limited, before)
        half = 0.5 * self._step / np.abs(self._ratio) * (1.0 + _EPSILON)
        saturated = np.abs(coil - demand) > half
        return Output(coil, coil * self._ratio, saturated, '')

    def zero(self, fault: str = '') -> Output:
        """Go to 0 V now, with a fault that latches when one is given."""
        self.fault = self.fault or fault
        self._guard.voltage = np.zeros_like(self._slew)
        return Output(self._guard.voltage, self._demand_zero, self._clear, self.fault)

    def reset(self) -> None:
        """Release the fault; the thermal load stays what it is."""
        if self.fault:
            self.fault = ''
            self._guard.reset()

    def _check(self, demand: Array, age: Array) -> None:
        for wrong, what, shown, unit in (
            (~np.isfinite(demand), 'the command is no number', demand, 'V'),
            (~(age <= self.max_age), 'stale command', age, 's old'),
            (self._load.load > 1.0, 'I^2 t, over the continuous rating', self._load.load, 'x'),
        ):
            if wrong.any() and not self.fault:
                which = int(np.argmax(wrong))
                self.fault = f'{self.names[which]}: {what} ({shown[which]:.3g} {unit})'

    def _quantized(self, coil: Array, before: Array) -> Array:
        """Round to codes of the converter, without leaving the limits that `coil` keeps.

        `before` is on a code already; stepping back towards it can violate neither limit.
        """
        exact = self._step == 0.0
        step = np.where(exact, 1.0, self._step)
        wanted, was = coil * self._ratio, before * self._ratio
        code = np.floor(wanted / step + 0.5)
        rounded = np.minimum(np.maximum(code * step, self._low), self._high)
        moved = np.abs(rounded - was) * (1.0 - _EPSILON) > self._guard.step * np.abs(self._ratio)
        over = np.abs(rounded) * (1.0 - _EPSILON) > self._guard.limit * np.abs(self._ratio)
        back = np.where(over, -np.sign(rounded), np.sign(was - rounded))
        rounded = np.where(moved | over, rounded + back * step, rounded)
        clamped = np.minimum(np.maximum(np.where(exact, wanted, rounded), self._low), self._high)
        return clamped / self._ratio + 0.0
