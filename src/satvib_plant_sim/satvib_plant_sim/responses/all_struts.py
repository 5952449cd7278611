# SPDX-FileCopyrightText: 2026 The satvib authors
# SPDX-License-Identifier: Apache-2.0
"""Exact responses from every voltage to every reading and to the payload, for a controller of all struts.

Sampled, with hold, latency, filter, sensor and coil (as `one_strut` does for one strut):

    zero hold:   u(k-D-1) for tau, then u(k-D)
    linear hold: the end of the line u(k-D-2) -> u(k-D-1) for tau, then the beginning of u(k-D-1) -> u(k-D)

Noise, quantization, stops and limits are left out. So are the images of a voltage above half the sample rate: the true
acceleration is that of the baseband.
"""

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike
from satvib_common.arrays import Array, Complex

from satvib_plant_sim.physics.mechanics import input_columns
from satvib_plant_sim.physics.state import size_of
from satvib_plant_sim.responses.continuous import moving_states, state_space
from satvib_plant_sim.responses.one_strut import hold_taps
from satvib_plant_sim.rig.rig import Rig
from satvib_plant_sim.stepping.discretize import output_rows


@dataclass(frozen=True)
class SampledRig:
    """x(k+1) = A x(k) + sum_i B[i] u(k-D-i), y(k) = C x(k).

    Attributes:
        A: (m, m), of the states that can move.
        B: (taps, m, n); two taps for zero hold, three for linear.
        C: (n, m), the readings of the upper sensors.
        late: D, whole periods of latency.
        dt: s.
    """

    A: Array
    B: Array
    C: Array
    late: int
    dt: float

    def response(self, frequency: ArrayLike) -> Complex:
        """Give y/u (f, n, n) at (f,) Hz."""
        z = np.exp(2j * math.pi * np.asarray(frequency, dtype=float) * self.dt)
        delays = z[:, None] ** -(self.late + np.arange(len(self.B)))
        drive = np.einsum('ft,tmn->fmn', delays, self.B)
        inner = z[:, None, None] * np.eye(len(self.A)) - self.A
        return np.asarray(self.C @ np.linalg.solve(inner, drive), dtype=complex)


def sampled_rig(rig: Rig) -> SampledRig:
    """Give the sampled model of a rig, all struts together."""
    size, T = size_of(rig), rig.acquisition.period
    system, moving = state_space(rig), moving_states(rig)
    A, B = system.A[np.ix_(moving, moving)], system.B[moving, input_columns(size).voltage]
    whole, taps, late = hold_taps(A, B, rig.acquisition)
    C = system.C[output_rows(size).read_upper][:, moving]
    return SampledRig(A=whole, B=np.stack(taps), C=C, late=late, dt=T)


@dataclass(frozen=True)
class RigResponse:
    """Responses at frequencies (f,); n struts.

    Attributes:
        frequency: (f,) Hz.
        read_voltage: (f, n, n) m/s^2 per V, readings per sampled voltage.
        true_voltage: (f, n, n) m/s^2 per V, upper plate at the struts per sampled voltage, baseband.
        read_source: (f, n, 2) readings per acceleration of the source and per N on the payload; of listed struts
            (f, n, 12), six directions of each.
        true_source: (f, n, 2) or (f, n, 12), the upper plate likewise.
    """

    frequency: Array
    read_voltage: Complex
    true_voltage: Complex
    read_source: Complex
    true_source: Complex


def rig_response(rig: Rig, frequency: ArrayLike) -> RigResponse:
    """Give the responses of a rig at (f,) Hz, none of them 0."""
    f = np.asarray(frequency, dtype=float)
    size, T = size_of(rig), rig.acquisition.period
    system = state_space(rig)
    s = 2j * math.pi * f
    inner = s[:, None, None] * np.eye(len(system.A)) - system.A
    inside = np.linalg.solve(inner, system.B[None])
    both = np.asarray(system.C @ inside + system.D, dtype=complex)
    rows, u = output_rows(size), input_columns(size)
    true, read = both[:, rows.upper], both[:, rows.read_upper]
    source = slice(u.base.start, u.payload.stop)
    step = (1.0 - np.exp(-s * T)) / (s * T)
    hold = step if rig.acquisition.hold == 'zero' else step * step
    hold = hold * np.exp(-s * rig.acquisition.input_delay)
    return RigResponse(
        frequency=f,
        read_voltage=sampled_rig(rig).response(f),
        true_voltage=true[:, :, u.voltage] * hold[:, None, None],
        read_source=read[:, :, source],
        true_source=true[:, :, source],
    )
