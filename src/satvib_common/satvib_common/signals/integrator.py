# SPDX-FileCopyrightText: 2026 The satvib authors
# SPDX-License-Identifier: Apache-2.0
"""Velocity from acceleration without drift.

A pure integrator turns a bias b of the sensor into a velocity b t: the drift that the paper describes below its Fig. 7.
Here the integrator has a leak, and a high-pass of the same corner comes before it,

    H(s) = s / (s + w_l)^2,

which has a zero at s = 0: a constant bias gives exactly 0 after the start-up has decayed, and far above the
corner H is 1/s. Discretised by Tustin's rule. The phase error at f is 2 atan(f_l / f).
"""

import math

from satvib_common.arrays import Array
from satvib_common.signals.iir_filter import IirFilter


def leaky_integrator(corner: float, dt: float) -> tuple[list[float], list[float]]:
    """Coefficients (b, a) in z^-1 of the drift-free integrator.

    Args:
        corner: Hz, where the integrator begins to integrate.
        dt: s, sample period.
    """
    w = 2.0 * math.pi * corner
    c = 2.0 / dt
    a0 = (c + w) * (c + w)
    b = [c / a0, 0.0, -c / a0]
    a = [1.0, 2.0 * (w * w - c * c) / a0, (c - w) * (c - w) / a0]
    return b, a


class LeakyIntegrator(IirFilter):
    """Acceleration in, velocity out, per item of `shape`; `corner` in Hz."""

    def __init__(self, corner: float, dt: float, shape: tuple[int, ...] = ()) -> None:
        super().__init__(*leaky_integrator(corner, dt), shape)

    def velocity(self, acceleration: Array) -> Array:
        """Take one sample (shape, m/s^2) and give the velocity (shape, m/s)."""
        return self.step(acceleration)
