# SPDX-FileCopyrightText: 2026 The satvib authors
# SPDX-License-Identifier: Apache-2.0
"""What a held voltage does between the samples: the tone, and its images around the multiples of the sample rate.

A tone Re(U e^{j w k T}) of voltages becomes, behind the hold H, the lines w_k = w + 2 pi k / T. P is the response from
the terminals of all struts, which a vibration from below moves alike, to the true acceleration at one of them. With
c_k = P(w_k) H(w_k) and a disturbance D at w alone, the payload has

    2 RMS^2 = |D + c_0 U|^2 + sum_{k != 0} |c_k U|^2,

least for U = -conj(c_0) D / sum |c_k|^2. A sensor behind its filter F reads F(w_0) D, and its samples fold all lines
onto w: G = sum F(w_k) c_k. A law that brings these samples to zero asks for -F D / G. The voltage that serves the
payload is v times that,

    v = (G / (F(w_0) c_0)) |c_0|^2 / sum |c_k|^2.

The first factor takes the false tone out of the samples. The second gives up what the images would cost. A strut knows
the response to its own voltage alone, G_1. What the others do is a part of its disturbance: with rho = G / G_1 and
d = y - G_1 u it finds d = F D / (1 + (rho - 1) W), and asks for u = -W d / G_1. The same voltage has the *weight*

    W = v_1 / (1 - v_1 (rho - 1)),    v_1 = v / rho.
"""

import math

import numpy as np
from numpy.typing import ArrayLike
from satvib_common.arrays import Array, Complex

from satvib_plant_sim.physics.state import size_of
from satvib_plant_sim.responses.continuous import frequency_response
from satvib_plant_sim.rig.rig import Acquisition, Rig
from satvib_plant_sim.stepping.discretize import output_rows

IMAGES = 60  # on either side; the rest is less than 1e-3 of the images


def hold_response(acquisition: Acquisition, frequency: ArrayLike) -> Complex:
    """Give the response (f,) of hold and latency at (f,) Hz, none of them 0; 1 is a straight wire."""
    s = 2j * math.pi * np.asarray(frequency, dtype=float)
    period = acquisition.period
    step = (1.0 - np.exp(-s * period)) / (s * period)
    shape = step if acquisition.hold == 'zero' else step * step
    return np.asarray(shape * np.exp(-s * acquisition.input_delay))


def lines(rig: Rig, strut_index: int, frequency: float) -> tuple[Complex, Complex, Complex]:
    """Give what a tone of the voltages becomes at the sensor of one strut, m/s^2 per V.

    Args:
        rig: the rig; without limits and stops.
        strut_index: from 0.
        frequency: Hz, from 0 (not included) to half the sample rate.

    Returns:
        (2 IMAGES + 1,) of the true acceleration and of the reading, with the same voltage at all struts, and of the
        reading with the strut's own voltage alone; the tone itself is in the middle.
    """
    n = rig.struts.count
    at = frequency + rig.acquisition.sample_rate * np.arange(-IMAGES, IMAGES + 1)
    response = (
        frequency_response(rig, at)[:, :, :n] * hold_response(rig.acquisition, at)[:, None, None]
    )
    together = response.sum(axis=-1)
    reading = output_rows(size_of(rig)).read_upper.start + strut_index
    return together[:, strut_index], together[:, reading], response[:, reading, strut_index]


def payload_weight(rig: Rig, frequency: ArrayLike) -> Complex:
    """Give the weights W (f,) at (f,) Hz, the mean of the struts."""
    found = [
        np.mean([_weight(*lines(rig, i, f)) for i in range(rig.struts.count)])
        for f in np.atleast_1d(np.asarray(frequency, dtype=float))
    ]
    return np.array(found)


def _weight(true: Complex, read: Complex, own: Complex) -> complex:
    share = abs(true[IMAGES]) ** 2 / float(np.sum(np.abs(true) ** 2))
    alone, all_of_them = complex(np.sum(own)), complex(np.sum(read))
    v = alone / complex(read[IMAGES]) * share
    return v / (1.0 - v * (all_of_them / alone - 1.0))


def weight_table(rig: Rig, low: float, high: float, size: int = 80) -> list[float]:
    """Give the weights from `low` to `high` Hz as one row: frequency (Hz), real and imaginary part, and so on."""
    at: Array = np.geomspace(low, high, size)
    weights = payload_weight(rig, at)
    return [float(x) for x in np.stack([at, weights.real, weights.imag], axis=1).ravel()]
