# SPDX-FileCopyrightText: 2026 The satvib authors
# SPDX-License-Identifier: Apache-2.0
"""Sensor noise at the converter: white noise through the sensor chain, sampled exactly.

The chain is linear, so the noise has states of its own and the truth has no noise. Between samples

    x(k+1) = E x(k) + L xi(k),   E = exp(A T),   L L' = Q(T) = int_0^T exp(A r) b q b' exp(A' r) dr

with xi standard normal. Q comes from one matrix exponential (Van Loan 1978, IEEE Trans. Automatic Control 23, 395) for
a T so short that its growing part exp(-A T) stays near one, then by doubling, Q(2t) = Q(t) + E(t) Q(t) E(t)', which
only adds. The first state is drawn from the stationary covariance Q(infinity), so there is no start-up.
"""

from functools import lru_cache
from typing import NamedTuple

import numpy as np
from satvib_common.arrays import Array
from satvib_common.kernels.compile import kernel

from satvib_plant_sim.physics.converters import lsb
from satvib_plant_sim.physics.matrix_exponential import exponential
from satvib_plant_sim.physics.sensor_chain import noise_intensity, sensor_chain
from satvib_plant_sim.rig.any_rig import AnyRig
from satvib_plant_sim.rig.identified_rig import IirRig
from satvib_plant_sim.rig.rig import Accelerometer, Acquisition, Rig

BLOCK = 128


def noise_floor(rig: AnyRig) -> float:
    """Give what one channel reads at rest, RMS about its mean, m/s^2: sensor noise and quantization (lsb^2 / 12)."""
    if isinstance(rig, IirRig):
        return rig.noise_floor()
    step = quantum(rig)
    return float(np.sqrt(noise_model(rig).covariance[-1, -1] + step * step / 12.0))


def quantum(rig: Rig) -> float:
    """Give the least significant bit of the input converter, m/s^2; 0 when it is exact."""
    volts = lsb(rig.acquisition.input_range, rig.acquisition.input_bits)
    return volts / rig.accelerometer.sensitivity


def _factor(covariance: Array) -> Array:
    """Lower Cholesky factor; all zero without noise."""
    scale = float(np.max(np.abs(covariance)))
    if scale == 0.0:
        return np.zeros_like(covariance)
    # in a short step the last stages hardly move: this keeps the matrix positive definite at rounding level
    tiny = np.eye(len(covariance)) * 1e-15
    factor: Array = np.linalg.cholesky(covariance / scale + tiny) * np.sqrt(scale)
    return factor


class NoiseModel(NamedTuple):
    """The noise of one channel, (c, c) each.

    Attributes:
        step: E.
        drive: L.
        start: factor of the stationary covariance.
        covariance: the stationary covariance; the last state is the converter's input.
    """

    step: Array
    drive: Array
    start: Array
    covariance: Array


def noise_model(rig: Rig) -> NoiseModel:
    """Give the noise model of a rig's channels."""
    return _noise_model(rig.accelerometer, rig.acquisition)


@lru_cache(maxsize=256)
def _noise_model(sensor: Accelerometer, acquisition: Acquisition) -> NoiseModel:
    """Make the model once for all rigs with the same sensors and acquisition."""
    A, b, _ = sensor_chain(sensor, acquisition)
    c = len(b)
    doublings = max(int(np.ceil(np.log2(2.0 * acquisition.period * np.abs(A).max()))), 0)
    big = np.zeros((2 * c, 2 * c))
    big[:c, :c], big[c:, c:] = -A, A.T
    big[:c, c:] = noise_intensity(sensor) * np.outer(b, b)
    F = exponential(big * (acquisition.period * 0.5**doublings))
    E = F[c:, c:].T.copy()
    Q = E @ F[:c, c:]
    for _ in range(doublings):
        E, Q = E @ E, Q + E @ Q @ E.T
    step, forever = E, Q
    while np.abs(step).max() > 1e-20:
        step, forever = step @ step, forever + step @ forever @ step.T
    forever = 0.5 * (forever + forever.T)
    return NoiseModel(
        step=E, drive=_factor(0.5 * (Q + Q.T)), start=_factor(forever), covariance=forever
    )


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


class NormalSource:
    """Standard normal numbers by sample index, from `default_rng([seed, stream, block])` per trial.

    A block of 128 samples per trial is held: 1 kB per number of a sample and trial.

    Args:
        seeds: one per trial.
        stream: which use of the seed this is (`Stream`).
        width: numbers per sample.
    """

    def __init__(self, seeds: list[int], stream: int, width: int) -> None:
        self._seeds = seeds
        self._stream = stream
        self._numbers = np.empty((BLOCK, len(seeds), width))
        self._block = -1

    def at(self, k: int) -> Array:
        """Give the numbers (trials, width) of sample k."""
        block, row = divmod(k, BLOCK)
        if block != self._block:
            self._block = block
            shape = (BLOCK, self._numbers.shape[2])
            for i, seed in enumerate(self._seeds):
                rng = np.random.default_rng([seed, self._stream, block])
                self._numbers[:, i] = rng.standard_normal(shape)
        row_of: Array = self._numbers[row]
        return row_of
