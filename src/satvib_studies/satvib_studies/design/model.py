# SPDX-FileCopyrightText: 2026 The satvib authors
# SPDX-License-Identifier: Apache-2.0
"""What a controller is designed on: the rig as it is sampled, with a model of what shakes it.

    x(k+1) = A x(k) + B (u(k) + n(k)) + w(k),    y(k) = C x(k) + e(k),    q(k) = Z x(k)

x are the mechanics, coils and upper sensor chains of the rig, the states of the disturbance, and the voltages that are
still on their way. It is the exact sampled model, with hold, latency and anti-alias filter. q are the payload's modes,
true, at the samples. The source's acceleration is two sorts of coloured noise together:

    broad band:  white noise through  s / (s + w_1) * w_2 / (s + w_2)
    tone:        white noise through  s / (s^2 + 2 zeta w_t s + w_t^2)

each scaled to the RMS that is given. Under listed struts there is one such source for each direction in which something
shakes, and they are independent. With a small zeta the second is nearly a sine of the nominal frequency, so that a
controller that is designed on it knows the tone. w is the effect of that noise in a period, e what the sensors add. The
noise n on the voltages stands for what the model of the rig does not know (loop transfer recovery).

The covariance of a period, Q = int_0^dt e^(A_c t) G G' e^(A_c' t) dt, comes from that of a 256th part of it, doubled
by Q_2h = Q_h + E_h Q_h E_h'. As P - E P E', with P the covariance of all times, it would lose so many digits that
with six struts it has negative eigenvalues, and the Riccati equation no solution.

References: Kwakernaak, Sivan, "Linear Optimal Control Systems" (1972); Van Loan, "Computing integrals involving the
matrix exponential", IEEE Trans. Automatic Control 23 (1978) 395; Doyle, Stein, "Robustness with observers", IEEE
Trans. Automatic Control 24 (1979) 607.
"""

import math
from dataclasses import dataclass

import numpy as np
from satvib_common.arrays import Array
from satvib_plant_sim.physics.mechanics import input_columns
from satvib_plant_sim.physics.state import size_of, state_size
from satvib_plant_sim.responses.continuous import moving_states, state_space
from satvib_plant_sim.responses.one_strut import hold_taps
from satvib_plant_sim.rig.payload_shapes import payload_modes
from satvib_plant_sim.rig.rig import Rig
from satvib_plant_sim.stepping.discretize import output_rows

_HALVINGS = 8  # so short a part of a period that the fastest filter hardly moves


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
        directions: of listed struts: the factors of each source along and about x, y, z of the base, then of the
            payload (12), per m/s^2 of the levels above; none: the base along z. Struts on a circle have one source,
            the base.
    """

    broad_band: float = 0.2
    low: float = 2.0
    high: float = 50.0
    tone: float = 0.35
    frequency: float = 9.0
    damping: float = 1e-3
    voltage_noise: float = 0.1
    sensor_noise: float = 0.01
    directions: tuple[tuple[float, ...], ...] = ()


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
    """Give one source as x' = A x + G w, a_d = c x with white noise w (2) of intensity 1."""
    w1, w2, wt = (2.0 * math.pi * f for f in (s.low, s.high, s.frequency))
    A, G = np.zeros((4, 4)), np.zeros((4, 2))
    # low-pass, then what the high-pass takes away
    A[0, 0], A[1, 0], A[1, 1] = -w2, w1, -w1
    G[0, 0] = s.broad_band * math.sqrt(2.0 * (w1 + w2))
    A[2, 3], A[3, 2], A[3, 3] = wt, -wt, -2.0 * s.damping * wt
    G[3, 1] = s.tone * math.sqrt(4.0 * s.damping * wt)
    return A, G, np.array([1.0, -1.0, 0.0, 1.0])


def noise_of_period(A: Array, G: Array, dt: float) -> Array:
    """Give the covariance (s, s) that white noise of intensity 1 makes in dt (s) by x' = A x + G w."""
    from scipy.linalg import expm

    s, h = len(A), dt / 2**_HALVINGS
    both = expm(h * np.block([[-A, G @ G.T], [np.zeros((s, s)), A.T]]))
    E = both[s:, s:].T
    Q = E @ both[:s, s:]
    for _ in range(_HALVINGS):
        Q = Q + E @ Q @ E.T
        E = E @ E
    return np.asarray(0.5 * (Q + Q.T))


def _along(rig: Rig, shaking: Shaking) -> Array:
    """Give the factors of the sources in the inputs of base and payload, (inputs, sources)."""
    _, base, payload = size_of(rig)
    if rig.struts.each and shaking.directions:
        return np.array(shaking.directions).T
    found = np.zeros((base + payload, 1))
    found[2 if rig.struts.each else 0] = 1.0
    return found


def design_model(rig: Rig, shaking: Shaking) -> DesignModel:
    """Give the model of a rig; the units of its states are such that each has about the RMS 1 at 0 V."""
    from scipy.linalg import solve_discrete_lyapunov

    n, sizes = rig.struts.count, size_of(rig)
    inputs, rows = input_columns(sizes), output_rows(sizes)
    system = state_space(rig)
    size, read = state_size(sizes), len(system.C) // 2
    # the chains of the lower sensors act on nothing
    keep = [i for i in moving_states(rig).tolist() if i < size or (i - size) % read < n]
    m = len(keep)
    along = _along(rig, shaking)
    A_d, G_d, c_d = (np.kron(np.eye(along.shape[1]), part) for part in _source(shaking))
    d = m + len(A_d)
    A_c, B_c, G_c = np.zeros((d, d)), np.zeros((d, n)), np.zeros((d, G_d.shape[1]))
    A_c[:m, :m] = system.A[np.ix_(keep, keep)]
    A_c[:m, m:] = system.B[keep, inputs.base.start : inputs.payload.stop] @ along @ c_d
    A_c[m:, m:], B_c[:m], G_c[m:] = A_d, system.B[keep, inputs.voltage], G_d
    E, taps, late = hold_taps(A_c, B_c, rig.acquisition)
    waiting = late + len(taps) - 1
    total = d + n * waiting
    A, B, Q = np.zeros((total, total)), np.zeros((total, n)), np.zeros((total, total))
    modes = payload_modes(rig).mode
    C, Z = np.zeros((n, total)), np.zeros((len(modes), total))
    A[:d, :d], Q[:d, :d] = E, noise_of_period(A_c, G_c, rig.acquisition.period)
    for i, tap in enumerate(taps):
        place = d + n * (late + i - 1)
        if late + i == 0:
            B[:d] = tap
        else:
            A[:d, place : place + n] = tap
    if waiting:
        B[d : d + n] = np.eye(n)
        A[d + n :, d : total - n] = np.eye(n * (waiting - 1))
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
