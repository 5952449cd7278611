# SPDX-FileCopyrightText: 2026 The satvib authors
# SPDX-License-Identifier: Apache-2.0
"""Sensor noise at the converter: white noise through the sensor chain, sampled exactly.

The chain is linear, so noise has states of its own and truth stays free of it. Between samples

    x(k+1) = E x(k) + L xi(k),   E = exp(A T),   L L' = Q(T) = int_0^T exp(A r) b q b' exp(A' r) dr

with xi standard normal. Q comes from one matrix exponential (Van Loan 1978, IEEE Trans. Automatic Control 23, 395) for
a T so short that its growing part exp(-A T) stays near one, then by doubling, Q(2t) = Q(t) + E(t) Q(t) E(t)', which
only adds. The first state is drawn from the stationary covariance Q(infinity), so there is no start-up.
"""

from functools import lru_cache

import numpy as np
from satvib_common.arrays import Array
from scipy.linalg import cholesky

from satvib_plant_sim.physics.matrix_exponential import exponential
from satvib_plant_sim.physics.sensor_chain import noise_intensity, sensor_chain
from satvib_plant_sim.rig.any_rig import AnyRig
from satvib_plant_sim.rig.identified_rig import IirRig
from satvib_plant_sim.rig.rig import Accelerometer, Acquisition, Rig

BLOCK = 128


def noise_covariance(rig: Rig) -> Array:
    """Give the stationary covariance (c, c) of a chain's noise states; the last is the converter's input."""
    return _noise_model(rig.accelerometer, rig.acquisition)[3]


def noise_floor(rig: AnyRig) -> float:
    """Give what one channel reads at rest, RMS about its mean, m/s^2: sensor noise and quantization (lsb^2 / 12)."""
    if isinstance(rig, IirRig):
        return rig.noise_floor()
    lsb = quantum(rig)
    return float(np.sqrt(noise_covariance(rig)[-1, -1] + lsb * lsb / 12.0))


def quantum(rig: Rig) -> float:
    """Give the least significant bit of the input converter, m/s^2; 0 when it is exact."""
    acquisition = rig.acquisition
    if acquisition.input_bits == 0:
        return 0.0
    volts = 2.0 * acquisition.input_range / 2.0**acquisition.input_bits
    return volts / rig.accelerometer.sensitivity


def _factor(covariance: Array) -> Array:
    """Lower Cholesky factor; all zero without noise."""
    scale = float(np.max(np.abs(covariance)))
    if scale == 0.0:
        return np.zeros_like(covariance)
    # the far stages of a short step hardly move: keep the factorization defined at rounding level
    tiny = np.eye(len(covariance)) * 1e-15
    factor: Array = cholesky(covariance / scale + tiny, lower=True) * np.sqrt(scale)
    return factor


def noise_model(rig: Rig) -> tuple[Array, Array, Array]:
    """Give E, L and the factor of the stationary covariance, each (c, c)."""
    return _noise_model(rig.accelerometer, rig.acquisition)[:3]


@lru_cache(maxsize=256)
def _noise_model(
    sensor: Accelerometer, acquisition: Acquisition
) -> tuple[Array, Array, Array, Array]:
    """Do the work once for all rigs that measure alike."""
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
    return E, _factor(0.5 * (Q + Q.T)), _factor(forever), forever


class NormalSource:
    """Standard normal numbers by sample index, from `default_rng([seed, stream, block])` per trial.

    A block of 128 samples per trial is held: 1 kB per number of a sample and trial.

    Args:
        seeds: one per trial.
        stream: tells the uses of a seed apart.
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
