# SPDX-FileCopyrightText: 2026 The satvib authors
# SPDX-License-Identifier: Apache-2.0
"""The voltage guard: every voltage of a controller passes through it."""

from dataclasses import dataclass

import numpy as np

from satvib_common.arrays import Array, Mask
from satvib_common.kernels.compile import kernel


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


@kernel(
    'void(f8, f8, f8, f8, b1, b1, f8[:], b1[:], b1[:])',
    '(),(),(),(),(),()->(),(),()',
)
def guard_step(demand, voltage, limit, step, stop, fault, out, saturated, latched):
    """Guard one demand.

    Args:
        demand: V.
        voltage: V, in force.
        limit, step: V, largest magnitude, and largest change.
        stop, fault: latch 0 V, and 0 V is latched.
        out, saturated, latched: results, see `Guarded`.
    """
    finite = abs(demand) < np.inf
    failed = fault or stop or not finite
    wanted = demand if finite else 0.0
    slewed = min(max(wanted, voltage - step), voltage + step)
    limited = min(max(slewed, -limit), limit)
    # + 0.0 turns a negative zero into zero, so that 0 V has one representation
    applied = (0.0 if failed else limited) + 0.0
    out[0] = applied
    saturated[0] = applied != wanted and not failed
    latched[0] = failed


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
        self.voltage, saturated, self.fault = guard_step(
            demand, self.voltage, self.limit, self.step, stop, self.fault
        )
        return Guarded(self.voltage, saturated, self.fault)

    def reset(self, mask: Mask | bool = True) -> None:
        """Release latched faults where `mask` (shape) holds; the output restarts from 0 V there."""
        self.fault = self.fault & ~np.asarray(mask)
        self.voltage = np.where(mask, 0.0, self.voltage)
