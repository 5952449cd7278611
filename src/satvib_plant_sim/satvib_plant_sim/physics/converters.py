# SPDX-FileCopyrightText: 2026 The satvib authors
# SPDX-License-Identifier: Apache-2.0
"""The converters of the acquisition and the amplifier behind them.

Input: the sensor chain's output y and its noise e are limited to the sensor's range; with sensitivity S, zero voltage
V_0 and the sensor's own bias b,

    volts = V_0 + S (b + s clip(y + e, +-range)),  code = floor(volts / lsb + 1/2) within +-full scale,
    reading = (code lsb - V_0) / S.

Output: volts / gain is limited and quantized likewise, multiplied by the amplifier's gain and limited to what it gives.
"""

import math

import numpy as np
from numba import njit
from satvib_common.kernels.compile import kernel

from satvib_plant_sim.rig.rig import Rig


@njit
def _converted(volts, full_scale, lsb):
    """What a converter makes of a voltage: limited, and rounded to its codes (lsb 0: not)."""
    if lsb > 0.0:
        code = math.floor(volts / lsb + 0.5)
        top = full_scale / lsb
        code = min(max(code, -top), top - 1.0)
        return code * lsb
    return min(max(volts, -full_scale), full_scale)


def input_settings(rig: Rig) -> list[float]:
    """Give range, sensitivity, zero voltage, full scale and lsb of a rig's input."""
    sensor, acquisition = rig.accelerometer, rig.acquisition
    return [
        sensor.range,
        sensor.sensitivity,
        sensor.zero_voltage,
        acquisition.input_range,
        lsb(acquisition.input_range, acquisition.input_bits),
    ]


def output_settings(rig: Rig) -> list[float]:
    """Give gain, voltage limit, full scale and lsb of a rig's output."""
    coil, acquisition = rig.coil, rig.acquisition
    return [
        coil.gain,
        coil.voltage_limit,
        acquisition.output_range,
        lsb(acquisition.output_range, acquisition.output_bits),
    ]


def lsb(full_scale: float, bits: int) -> float:
    """Give the step of a converter of +-full_scale, V; 0 without bits."""
    return 2.0 * full_scale / 2.0**bits if bits else 0.0


@kernel(
    'void(f8[:],f8[:],f8[:],f8[:],f8[:,:],f8[:])',
    '(r),(s),(m),(m),(m,q)->(m)',
)
def read_input(state, settings, bias, scale, noise, reading):
    """Read the 2n converters (upper, then lower) from the state (R) and the noise states (2n, c)."""
    n = bias.shape[0] // 2
    stages = noise.shape[1]
    last = state.shape[0] - 4
    top = settings[0]
    for i in range(2 * n):
        lane = min(n, i)
        y = state[last + lane] + noise[i, stages - 1]
        y = scale[i] * min(max(y, -top), top)
        volts = settings[2] + settings[1] * (bias[i] + y)
        volts = _converted(volts, settings[3], settings[4])
        reading[i] = (volts - settings[2]) / settings[1]


@kernel(
    'void(f8[:,:],f8[:,:],f8[:,:],f8[:,:],f8[:])',
    '(q,q),(q,q),(m,q),(m,q)->(q)',
    writable=('noise',),
)
def advance_noise(E, L, normal, noise, scratch):
    """Take the noise states one sample on: E noise + L normal, per channel."""
    stages = noise.shape[1]
    for i in range(noise.shape[0]):
        for p in range(stages):
            total = 0.0
            for q in range(stages):
                total += E[p, q] * noise[i, q]
            for q in range(p + 1):
                total += L[p, q] * normal[i, q]
            scratch[p] = total
        for p in range(stages):
            noise[i, p] = scratch[p]


@kernel('void(f8[:],f8[:],f8[:])', '(n),(s)->(n)')
def drive_output(voltage, settings, terminal):
    """Give the voltages (n) at the terminals for the voltages (n) asked for."""
    for i in range(voltage.shape[0]):
        volts = _converted(voltage[i] / settings[0], settings[2], settings[3]) * settings[0]
        terminal[i] = min(max(volts, -settings[1]), settings[1]) + 0.0


def sensor_scale(rig: Rig) -> list[float]:
    """Give the factor on what each of the 2n sensors shows."""
    scale, sensors = rig.accelerometer.scale, 2 * rig.struts.count
    return list(scale) if len(scale) == sensors else list(scale) * sensors


def drawn_bias(rig: Rig, seed: int) -> list[float]:
    """Give the bias of the 2n sensors, m/s^2: what the rig says, or drawn within the zero-voltage tolerance."""
    if rig.accelerometer.bias is not None:
        return list(rig.accelerometer.bias)
    tolerance = rig.accelerometer.zero_tolerance / rig.accelerometer.sensitivity
    rng = np.random.default_rng([seed, 0])
    return [float(b) for b in tolerance * rng.uniform(-1.0, 1.0, 2 * rig.struts.count)]
