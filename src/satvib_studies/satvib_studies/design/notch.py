# SPDX-FileCopyrightText: 2026 The satvib authors
# SPDX-License-Identifier: Apache-2.0
"""A fixed damper with a fixed notch, for one strut: what one builds when the tone is known.

    u = -(G_d + G_p H + G_i H^2) y - g Re(e^{j phi} x),    x(k) = r e^{j w} x(k-1) + y(k)

H is the drift-free integrator, as in the laws `velocity_feedback` and `centralized`. x is a resonator at the tone's
frequency w, r < 1 says how wide it is. Where its gain g / (1 - r) is large the sensitivity has a notch. phi turns the
voltage so that it meets the tone; it is a number of the design, found on the rig as it is and its perturbed plants.
Nothing adapts.

The resonator would wind up while the voltage is not applied. So it follows the applied voltage v:

    x+ = A x + B y + F (v - u),    F such that its poles are those of a decay in `FORGETS` s where v does not move

Where v = u nothing changes (Astrom, Rundqwist, "Integrator windup and how to avoid it", American Control Conference
1989). The integrators leak by themselves.
"""

import math

import numpy as np
from satvib_common.arrays import Array
from satvib_common.signals.integrator import leaky_integrator
from satvib_control.laws.state_space.matrices import Matrices

FORGETS = 0.3  # s, as the integrators of 0.5 Hz


def _integrator(corner: float, dt: float) -> tuple[Array, Array, Array, float]:
    """Give H in state space: A (2, 2), b (2), c (2), d."""
    b, a = leaky_integrator(corner, dt)
    d = b[0]
    A = np.array([[-a[1], -a[2]], [1.0, 0.0]])
    return A, np.array([1.0, 0.0]), np.array([b[1] - a[1] * d, b[2] - a[2] * d]), d


def design_notch(
    gains: tuple[float, float, float],
    corner: float,
    frequency: float,
    width: float,
    gain: float,
    phase: float,
    dt: float,
) -> Matrices:
    """Give the controller of a strut.

    Args:
        gains: G_p in V/(m/s), G_i in V/m, G_d in V/(m/s^2).
        corner: Hz, of the integrators.
        frequency: Hz, of the tone.
        width: Hz, of the resonator between its -3 dB points; r = exp(-pi width dt).
        gain: g, V/(m/s^2).
        phase: phi, rad.
        dt: s.
    """
    g_p, g_i, g_d = gains
    A_h, b_h, c_h, d_h = _integrator(corner, dt)
    A, B, C = np.zeros((6, 6)), np.zeros((6, 1)), np.zeros((1, 6))
    # velocity v = c x1 + d y, position c x2 + d v
    A[:2, :2], B[:2, 0] = A_h, b_h
    A[2:4, :2], A[2:4, 2:4], B[2:4, 0] = np.outer(b_h, c_h), A_h, b_h * d_h
    C[0, :2] = -(g_p * c_h + g_i * d_h * c_h)
    C[0, 2:4] = -g_i * c_h
    w, r = 2.0 * math.pi * frequency * dt, math.exp(-math.pi * width * dt)
    turn = r * np.array([[math.cos(w), -math.sin(w)], [math.sin(w), math.cos(w)]])
    # the state is r e^{jw} x(k-1)
    A[4:, 4:], B[4:, 0] = turn, turn[:, 0]
    C[0, 4:] = -gain * math.cos(phase), gain * math.sin(phase)
    D = np.array([[-(g_d + g_p * d_h + g_i * d_h * d_h) - gain * math.cos(phase)]])
    F = np.zeros((6, 1))
    F[4:, 0] = _following(turn, C[0, 4:], math.exp(-dt / FORGETS))
    return Matrices(A=A - F @ C, B=B - F @ D, C=C, D=D, E=F)


def _following(A: Array, c: Array, radius: float) -> Array:
    """Give f (2) for which A (2, 2) - f c has poles at the angle of those of A and at a radius; 0 where c is 0.

    By Ackermann's formula, f = p(A) O^-1 (0, 1)' with p the wanted polynomial and O the observability matrix.
    """
    seen = np.stack([c, c @ A])
    if not abs(np.linalg.det(seen)) > 0.0:
        return np.zeros(2)
    wanted = radius / math.sqrt(float(np.linalg.det(A)))
    # p(z) = z^2 - wanted trace(A) z + radius^2
    p = A @ A - wanted * np.trace(A) * A + radius * radius * np.eye(2)
    return np.asarray(p @ np.linalg.solve(seen, np.array([0.0, 1.0])))
