# SPDX-FileCopyrightText: 2026 The satvib authors
# SPDX-License-Identifier: Apache-2.0
"""What a controller is designed on: the rig as it is sampled, with a model of what shakes it.

    x(k+1) = A x(k) + B (u(k) + n(k)) + w(k),    y(k) = C x(k) + e(k),    q(k) = Z x(k)

x are the mechanics, coils and upper sensor chains of the rig, the states of the disturbance, and the voltages that are
still on their way. It is the exact sampled model, with hold, latency and anti-alias filter. q are the payload's modes,
true, at the samples. The source's acceleration is two sorts of coloured noise together (of listed struts along z):

    broad band:  white noise through  s / (s + w_1) * w_2 / (s + w_2)
    tone:        white noise through  s / (s^2 + 2 zeta w_t s + w_t^2)

each scaled to the RMS that is given. With a small zeta the second is nearly a sine of the nominal frequency, so that a
controller that is designed on it knows the tone. w is the effect of that noise in a period, e what the sensors add. The
noise n on the voltages stands for what the model of the rig does not know (loop transfer recovery).

Covariances of periods come from that of all times: with P = E P E' + Q, A_c P + P A_c' + G G' = 0, Q = P - E P E'.

References: Kwakernaak, Sivan, "Linear Optimal Control Systems" (1972); Doyle, Stein, "Robustness with observers", IEEE
Trans. Automatic Control 24 (1979) 607.
"""

import math
from dataclasses import dataclass

import numpy as np
from satvib_common.arrays import Array
from satvib_plant_sim.physics.mechanics import input_columns
from satvib_plant_sim.physics.state import size_of, state_size
from satvib_plant_sim.responses.continuous import state_space
from satvib_plant_sim.responses.one_strut import hold_taps
from satvib_plant_sim.rig.payload_shapes import payload_modes
from satvib_plant_sim.rig.rig import Rig
from satvib_plant_sim.stepping.discretize import output_rows


@dataclass(frozen=True)
class Shaking:
    """What a controller is told of the vibration and of what it cannot know.

    Attributes:
        broad_band: m/s^2 RMS of the source.
        low, high: Hz, corners of the broad band.
        tone: m/s^2 RMS of the source.
        frequency: Hz, of the tone.
        damping: damping ratio of the tone's resonance.
        voltage_noise: V RMS on each voltage, at each sample.
        sensor_noise: m/s^2 RMS on each reading, at each sample.
    """

    broad_band: float = 0.2
    low: float = 2.0
    high: float = 50.0
    tone: float = 0.35
    frequency: float = 9.0
    damping: float = 1e-3
    voltage_noise: float = 0.1
    sensor_noise: float = 0.01


@dataclass(frozen=True)
class DesignModel:
    """The model; s states, n struts. See the module.

    Attributes:
        A: (s, s).
        B: (s, n).
        C: (n, s) m/s^2.
        Z: (modes, s) m/s^2 of the modes.
        Q: (s, s) covariance of w and of the effect of n together.
        R: (n, n) covariance of e, (m/s^2)^2.
    """

    A: Array
    B: Array
    C: Array
    Z: Array
    Q: Array
    R: Array


def _source(s: Shaking) -> tuple[Array, Array, Array]:
    """Give the disturbance as x' = A x + G w, a_d = c x with white noise w (2) of intensity 1."""
    w1, w2, wt = (2.0 * math.pi * f for f in (s.low, s.high, s.frequency))
    A, G = np.zeros((4, 4)), np.zeros((4, 2))
    # low-pass, then what the high-pass takes away
    A[0, 0], A[1, 0], A[1, 1] = -w2, w1, -w1
    G[0, 0] = s.broad_band * math.sqrt(2.0 * (w1 + w2))
    A[2, 3], A[3, 2], A[3, 3] = wt, -wt, -2.0 * s.damping * wt
    G[3, 1] = s.tone * math.sqrt(4.0 * s.damping * wt)
    return A, G, np.array([1.0, -1.0, 0.0, 1.0])


def design_model(rig: Rig, shaking: Shaking) -> DesignModel:
    """Give the model of a rig; the units of its states are such that each has about the RMS 1 at 0 V."""
    from scipy.linalg import solve_continuous_lyapunov, solve_discrete_lyapunov

    n, sizes = rig.struts.count, size_of(rig)
    inputs, rows = input_columns(sizes), output_rows(sizes)
    system = state_space(rig)
    size, read = state_size(sizes), len(system.C) // 2
    along = inputs.base.start + (2 if rig.struts.each else 0)
    # the chains of the lower sensors act on nothing
    keep = [i for i in range(len(system.A)) if i < size or (i - size) % read < n]
    m = len(keep)
    A_d, G_d, c_d = _source(shaking)
    A_c, B_c, G_c = np.zeros((m + 4, m + 4)), np.zeros((m + 4, n)), np.zeros((m + 4, 2))
    A_c[:m, :m] = system.A[np.ix_(keep, keep)]
    A_c[:m, m:] = np.outer(system.B[keep, along], c_d)
    A_c[m:, m:], B_c[:m], G_c[m:] = A_d, system.B[keep, inputs.voltage], G_d
    E, taps, late = hold_taps(A_c, B_c, rig.acquisition)
    P = solve_continuous_lyapunov(A_c, -G_c @ G_c.T)
    waiting = late + len(taps) - 1
    total = m + 4 + n * waiting
    A, B, Q = np.zeros((total, total)), np.zeros((total, n)), np.zeros((total, total))
    modes = payload_modes(rig).mode
    C, Z = np.zeros((n, total)), np.zeros((len(modes), total))
    A[: m + 4, : m + 4], Q[: m + 4, : m + 4] = E, P - E @ P @ E.T
    for i, tap in enumerate(taps):
        place = m + 4 + n * (late + i - 1)
        if late + i == 0:
            B[: m + 4] = tap
        else:
            A[: m + 4, place : place + n] = tap
    if waiting:
        B[m + 4 : m + 4 + n] = np.eye(n)
        A[m + 4 + n :, m + 4 : total - n] = np.eye(n * (waiting - 1))
    C[:, :m] = system.C[rows.read_upper][:, keep]
    Z[:, :m] = modes @ system.C[rows.upper][:, keep]
    Q += shaking.voltage_noise**2 * B @ B.T
    scale = np.sqrt(np.maximum(np.diag(solve_discrete_lyapunov(A, Q)), 1e-24))
    Q = Q / np.outer(scale, scale)
    return DesignModel(
        A=A / scale[:, None] * scale,
        B=B / scale[:, None],
        C=C * scale,
        Z=Z * scale,
        Q=0.5 * (Q + Q.T),
        R=shaking.sensor_noise**2 * np.eye(n),
    )
