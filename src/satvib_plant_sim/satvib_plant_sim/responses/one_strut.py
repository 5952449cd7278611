# SPDX-FileCopyrightText: 2026 The satvib authors
# SPDX-License-Identifier: Apache-2.0
"""The model that an identifier of one strut should find: the exact sampled model from its voltage to its own reading.

The other struts are at 0 V. Hold, latency, anti-alias filter, sensor and coil are included; noise, quantization and
limits are not. With the latency D T + tau, 0 <= tau < T, the voltage of period k is

    zero hold:   u(k-D-1) for tau, then u(k-D)
    linear hold: the end of the line u(k-D-2) -> u(k-D-1) for tau, then the beginning of u(k-D-1) -> u(k-D)

so x(k+1) = E x(k) + sum_i G_i u(k-D-i), y(k) = c x(k), each G_i exact.
"""

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike
from satvib_common.arrays import Array, Complex

from satvib_plant_sim.physics.state import size_of, state_size
from satvib_plant_sim.responses.continuous import state_space
from satvib_plant_sim.rig.any_rig import AnyRig
from satvib_plant_sim.rig.rig import Acquisition, Rig
from satvib_plant_sim.stepping.discretize import output_rows, transition


@dataclass(frozen=True)
class SampledModel:
    """x(k+1) = A x(k) + sum_i B[:, i] u(k-D-i), y(k) = c x(k).

    Attributes:
        A: (m, m).
        B: (m, 2) for zero hold, (m, 3) for linear.
        c: (m,).
        late: D, whole periods of latency.
        dt: sample period, s.
    """

    A: Array
    B: Array
    c: Array
    late: int
    dt: float

    def response(self, frequency: ArrayLike) -> Complex:
        """Give y/u (...) at frequencies (...), Hz."""
        f = np.asarray(frequency, dtype=float)
        found = []
        for x in f.ravel():
            z = np.exp(2j * math.pi * x * self.dt)
            delays = z ** -(self.late + np.arange(self.B.shape[1]))
            found.append(
                self.c @ np.linalg.solve(z * np.eye(len(self.A)) - self.A, self.B @ delays)
            )
        return np.array(found, dtype=complex).reshape(f.shape)

    def simulate(self, voltage: ArrayLike) -> Array:
        """Give y(0..) for u(0..), both (samples,), from rest."""
        u = np.asarray(voltage, dtype=float)
        past = np.concatenate([np.zeros(self.late + self.B.shape[1] - 1), u])
        x = np.zeros(len(self.A))
        y = np.empty(len(u))
        for k in range(len(u)):
            y[k] = self.c @ x
            now = k + self.B.shape[1] - 1
            x = self.A @ x + self.B @ past[now - np.arange(self.B.shape[1])]
        return y

    def coefficients(self) -> tuple[Array, Array, int]:
        """Give a, b and the delay of y(k) + a_1 y(k-1) + ... = b_1 u(k-delay) + b_2 u(k-delay-1) + ...

        The order is that of the state. The highest coefficients are tiny: their poles are much faster than a sample.
        """
        m = len(self.A)
        a = np.poly(self.A)
        # the first samples of the impulse response times A(q) give B(q), which ends after m + taps - 1 of them
        markov = np.zeros(m + self.B.shape[1] + 1)
        state = self.B.copy()
        for k in range(1, len(markov)):
            for i in range(self.B.shape[1]):
                if k + i < len(markov):
                    markov[k + i] += self.c @ state[:, i]
            state = self.A @ state
        b = np.convolve(a, markov)[1 : m + self.B.shape[1]]
        return np.asarray(a[1:]), b, self.late + 1


def hold_taps(A: Array, B: Array, acquisition: Acquisition) -> tuple[Array, list[Array], int]:
    """Sample x' = A x + B u behind the hold and the latency of the voltages.

    Args:
        A: (m, m).
        B: (m, n).
        acquisition: hold, latency and period.

    Returns:
        (m, m) transition over a period; the matrices (m, n) of u(k-D), u(k-D-1), ...; D, whole periods of latency.
    """
    T = acquisition.period
    late = math.floor(acquisition.input_delay / T + 1e-9)
    tau = max(acquisition.input_delay - late * T, 0.0)
    whole = transition(A, B, T)[0]
    rest, G0, G1 = transition(A, B, T - tau)
    _, P0, P1 = transition(A, B, tau)
    P0, P1 = rest @ P0, rest @ P1
    if acquisition.hold == 'zero':
        return whole, [G0, P0], late
    # the old line's value at the start of the period is u_2 + (u_1 - u_2) (1 - tau / T)
    part = tau / T
    return whole, [G1 / T, G0 - G1 / T + (1.0 - part) * P0 + P1 / T, part * P0 - P1 / T], late


def discrete_strut_model(rig: Rig, strut_index: int = 0) -> SampledModel:
    """Give the sampled model of one strut (index 0 is the first)."""
    size, T = size_of(rig), rig.acquisition.period
    system = state_space(rig)
    # the mechanics and this strut's own sensor chain; the other chains act on nothing
    states, chains = state_size(size), len(system.C) // 2
    own = np.arange(states + strut_index, len(system.A), chains)
    keep = np.concatenate([np.arange(states), own])
    A, b = system.A[np.ix_(keep, keep)], system.B[keep, strut_index : strut_index + 1]
    c = system.C[output_rows(size).read_upper, keep][strut_index]
    whole, taps, late = hold_taps(A, b, rig.acquisition)
    return SampledModel(A=whole, B=np.hstack(taps), c=c, late=late, dt=T)


def strut_response(rig: AnyRig, strut_index: int, frequency: Array) -> Complex:
    """Give the exact sampled response (f,) from a strut's voltage to its own reading, m/s^2 per V, at (f,) Hz."""
    if isinstance(rig, Rig):
        return discrete_strut_model(rig, strut_index).response(frequency)
    model = rig.models[strut_index]
    z = np.exp(-2j * np.pi * frequency * rig.acquisition.period)
    response: Complex = (
        z**model.delay * np.polyval(model.b[::-1], z) / np.polyval([*model.a[::-1], 1.0], z)
    )
    return response
