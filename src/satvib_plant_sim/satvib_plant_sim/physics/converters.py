# SPDX-FileCopyrightText: 2026 The satvib authors
# SPDX-License-Identifier: Apache-2.0
"""The converters of the acquisition and the amplifier behind them.

Input: the sensor chain's output y and its noise e are limited to the sensor's range; with sensitivity S, zero voltage
V_0 and the sensor's own bias b,

    volts = V_0 + S (b + s clip(y + e, +-range)),  code = floor(volts / lsb + 1/2) within +-full scale,
    reading = (code lsb - V_0) / S.

A reading is *clipped* where the sensor or its converter stands at an end of its range, or nearer to it than `MARGIN` of
the range: there the acceleration is at least what the reading says. `satvib_daq_bridge` has the same rule.

Output: volts / gain is limited and quantized in the same way, multiplied by the amplifier's gain, and limited to the
amplifier's range.
"""

import math
from typing import NamedTuple

import numpy as np
from satvib_common.kernels.compile import kernel
from satvib_common.kernels.deferred import njit

from satvib_plant_sim.rig.rig import Rig
from satvib_plant_sim.rig.streams import Stream

MARGIN = 0.005  # of a range; nearer to its end a reading counts as clipped


@njit
def _converted(volts, full_scale, lsb):
    """Limit a voltage, and round it to the codes of a converter (lsb 0: not rounded)."""
    if lsb > 0.0:
        code = math.floor(volts / lsb + 0.5)
        top = full_scale / lsb
        code = min(max(code, -top), top - 1.0)
        return code * lsb
    return min(max(volts, -full_scale), full_scale)


class InputSettings(NamedTuple):
    """A sensor and its converter: range in m/s^2, V s^2/m, then V."""

    range: float
    sensitivity: float
    zero_voltage: float
    full_scale: float
    lsb: float


class OutputSettings(NamedTuple):
    """A converter and its amplifier: gain, then V."""

    gain: float
    voltage_limit: float
    full_scale: float
    lsb: float


def input_settings(rig: Rig) -> InputSettings:
    """Give the settings of a rig's inputs."""
    sensor, acquisition = rig.accelerometer, rig.acquisition
    return InputSettings(
        range=sensor.range,
        sensitivity=sensor.sensitivity,
        zero_voltage=sensor.zero_voltage,
        full_scale=acquisition.input_range,
        lsb=lsb(acquisition.input_range, acquisition.input_bits),
    )


def output_settings(rig: Rig) -> OutputSettings:
    """Give the settings of a rig's outputs."""
    coil, acquisition = rig.coil, rig.acquisition
    return OutputSettings(
        gain=coil.gain,
        voltage_limit=coil.voltage_limit,
        full_scale=acquisition.output_range,
        lsb=lsb(acquisition.output_range, acquisition.output_bits),
    )


def lsb(full_scale: float, bits: int) -> float:
    """Give the step of a converter of +-full_scale, V; 0 without bits."""
    return 2.0 * full_scale / 2.0**bits if bits else 0.0


@kernel(
    'void(f8[:],f8,f8[:],f8[:],f8[:],f8[:,:],f8[:],f8[:])',
    '(r),(),(s),(m),(m),(m,q)->(m),(m)',
)
def read_input(chains, lower, settings, bias, scale, noise, reading, clipped):
    """Read the 2n converters (upper, then lower) from the ends of the sensor chains (r) and the noise states (2n, c).

    Chain i belongs to upper sensor i. There are `lower` chains of lower sensors: one for all of them, or n. `clipped`
    is 1 where a reading is clipped.
    """
    n = bias.shape[0] // 2
    last_chain = n + int(lower) - 1
    last = noise.shape[1] - 1
    s = InputSettings(settings[0], settings[1], settings[2], settings[3], settings[4])
    for i in range(2 * n):
        y = chains[min(last_chain, i)] + noise[i, last]
        at_end = abs(y) >= (1.0 - MARGIN) * s.range
        y = scale[i] * min(max(y, -s.range), s.range)
        volts = s.zero_voltage + s.sensitivity * (bias[i] + y)
        volts = _converted(volts, s.full_scale, s.lsb)
        railed = abs(volts) >= s.full_scale - max(2.0 * MARGIN * s.full_scale, s.lsb)
        clipped[i] = 1.0 if at_end or railed else 0.0
        reading[i] = (volts - s.zero_voltage) / s.sensitivity


@kernel('void(f8[:],f8[:],f8[:])', '(n),(s)->(n)')
def drive_output(voltage, settings, terminal):
    """Give the voltages (n) at the terminals for the voltages (n) asked for."""
    s = OutputSettings(settings[0], settings[1], settings[2], settings[3])
    for i in range(voltage.shape[0]):
        volts = _converted(voltage[i] / s.gain, s.full_scale, s.lsb) * s.gain
        terminal[i] = min(max(volts, -s.voltage_limit), s.voltage_limit) + 0.0


def sensor_scale(rig: Rig) -> list[float]:
    """Give the factor on what each of the 2n sensors shows."""
    scale, sensors = rig.accelerometer.scale, 2 * rig.struts.count
    return list(scale) if len(scale) == sensors else list(scale) * sensors


def drawn_bias(rig: Rig, seed: int) -> list[float]:
    """Give the bias of the 2n sensors, m/s^2: what the rig says, or drawn within the zero-voltage tolerance."""
    if rig.accelerometer.bias is not None:
        return list(rig.accelerometer.bias)
    tolerance = rig.accelerometer.zero_tolerance / rig.accelerometer.sensitivity
    rng = np.random.default_rng([seed, Stream.BIAS])
    return [float(b) for b in tolerance * rng.uniform(-1.0, 1.0, 2 * rig.struts.count)]
