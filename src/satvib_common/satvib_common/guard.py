# SPDX-FileCopyrightText: 2026 The satvib authors
# SPDX-License-Identifier: Apache-2.0
"""The voltage guard: every voltage of a controller passes through it."""

from dataclasses import dataclass

import numpy as np

from satvib_common.arrays import Array, Mask


@dataclass(frozen=True)
class Guarded:
    """What the guard applies.

    Attributes:
        voltage: shape, V; what is really applied.
        saturated: shape, bool; the limit or the slew limit changed the demand.
        fault: shape, bool; latched.
    """

    voltage: Array
    saturated: Mask
    fault: Mask


def towards_zero(voltage: Array, step: Array | float) -> Array:
    """Move voltages (shape, V) by a step (shape or one for all, V, at least 0) towards 0 V, and not beyond it."""
    # + 0.0 turns a negative zero into zero
    return np.copysign(np.maximum(np.abs(voltage) - step, 0.0), voltage) + 0.0


class VoltageGuard:
    """Finite, |V| <= limit, |dV| <= slew dt; a demand that is not finite latches 0 V until `reset`.

    The output obeys these limits whatever a law asks for. A latched fault goes to 0 V at once, because at 0 V a coil
    only damps. The slew limit applies to demands, not to stopping.

    Args:
        limit: V, largest magnitude; one for all, or shape.
        slew: V/s, largest rate; infinity for none; one for all, or shape.
        dt: s, sample period.
        shape: leading axes.
    """

    def __init__(
        self,
        limit: float | Array,
        slew: float | Array,
        dt: float,
        shape: tuple[int, ...] = (),
    ) -> None:
        self.limit = limit
        self.step = slew * dt
        self.voltage = np.zeros(shape)
        self.fault = np.zeros(shape, dtype=bool)

    def apply(self, demand: Array, stop: Mask | bool = False) -> Guarded:
        """Limit a demand (shape, V); `stop` (shape) latches 0 V."""
        finite = np.isfinite(demand)
        self.fault = self.fault | ~finite | stop
        wanted = np.where(finite, demand, 0.0)
        slewed = np.minimum(np.maximum(wanted, self.voltage - self.step), self.voltage + self.step)
        limited = np.minimum(np.maximum(slewed, -self.limit), self.limit)
        # + 0.0 turns a negative zero into zero, so that 0 V has one representation
        self.voltage = np.where(self.fault, 0.0, limited) + 0.0
        return Guarded(self.voltage, (self.voltage != wanted) & ~self.fault, self.fault)

    def reset(self, mask: Mask | bool = True) -> None:
        """Release latched faults where `mask` (shape) holds; the output restarts from 0 V there."""
        self.fault = self.fault & ~np.asarray(mask)
        self.voltage = np.where(mask, 0.0, self.voltage)
