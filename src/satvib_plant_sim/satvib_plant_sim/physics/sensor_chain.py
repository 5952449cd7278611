# SPDX-FileCopyrightText: 2026 The satvib authors
# SPDX-License-Identifier: Apache-2.0
"""What stands between an acceleration and the converter: the accelerometer's bandwidth and the anti-alias filter.

    x' = A x + b a,   y = c x,    G(s) = w_b / (s + w_b) * Butterworth_N(s; w_c),   G(0) = 1

as a cascade, one real pole or one pair after the other, so that A is block lower triangular and well scaled. With
white noise of intensity q at the sensor's input, its own output has the variance q w_b / 2: that is how the stated
`noise_rms` becomes q.
"""

import math

import numpy as np
from satvib_common.arrays import Array

from satvib_plant_sim.rig.rig import Accelerometer, Acquisition


def sensor_chain(sensor: Accelerometer, acquisition: Acquisition) -> tuple[Array, Array, Array]:
    """Give (A, b, c) of one channel; the order is 1 + filter_order, and c picks the last state."""
    wb = 2.0 * math.pi * sensor.bandwidth
    order = acquisition.filter_order
    wc = 2.0 * math.pi * acquisition.filter_corner
    size = 1 + order
    A, b, c = np.zeros((size, size)), np.zeros(size), np.zeros(size)
    A[0, 0], b[0] = -wb, wb
    last, row = 0, 1
    if order % 2:
        A[row, row], A[row, last] = -wc, wc
        last, row = row, row + 1
    for pair in range(order // 2):
        # scaled so that both states are accelerations: x1' = wc (u - x2 - 2 zeta x1), x2' = wc x1
        zeta = math.sin(math.pi * (2 * pair + 1) / (2 * order))
        A[row, last] = wc
        A[row, row], A[row, row + 1] = -2.0 * zeta * wc, -wc
        A[row + 1, row] = wc
        last, row = row + 1, row + 2
    c[-1] = 1.0
    return A, b, c


def noise_intensity(sensor: Accelerometer) -> float:
    """Give q, (m/s^2)^2 s: intensity of the white noise at the sensor's input."""
    wb = 2.0 * math.pi * sensor.bandwidth
    return 2.0 * sensor.noise_rms**2 / wb
