# SPDX-FileCopyrightText: 2026 The satvib authors
# SPDX-License-Identifier: Apache-2.0
"""What a feedforward filter is a weighted sum of, and the same seen through the secondary path.

The reference x is the lower plate's acceleration without the strut's own reaction (`reference_protection`). The filter
is u(k) = w^T phi(k) with the regressor

    phi(k) = [x(k) ... x(k-L+1),  w_0 v(k), w_0^2 s(k),  u(k-1) ... u(k-P)],

L taps, velocity v and displacement s of the lower plate, P own past voltages (filtered-u only). Physics asks for v and
s: a strut that passes no force needs u = -(R / k_F) (C v + K s), a double integrator that an FIR filter would need
seconds of taps to resemble. They come from drift-free integrators,

    v / x = s / (s + w_m)^2,    s / x = s / (s + w_m)^3    (s: Laplace's on the right),

by Tustin's rule, and are scaled by w_0 = 2 pi 10 rad/s so that all weights are of one size.

Filtered-x: phi_f = G_hat phi. G_hat is linear and so are the filters above: phi_f is made like phi, from x_f = G_hat x
and u_f = G_hat u. The same kernel runs over a whole history when G_hat changes, so that a new model finds phi_f and its
filters as if it had been there all the time. With poles there is also phi_g = phi_f / (1 - C), see `filtered_u`.
"""

import math

import numpy as np
from numba import njit
from satvib_common.arrays import Array
from satvib_common.kernels.compile import kernel
from satvib_common.kernels.direct_form import filter_sample

SCALE = 2.0 * math.pi * 10.0
MOTION = 3  # states of the motion filters


def motion_coefficients(corner: float, dt: float) -> Array:
    """Coefficients of the motion filters: gain and pole of each first-order section, by Tustin's rule.

    1 / (s + w) becomes g (1 + z^-1) / (1 - p z^-1), s / (s + w) becomes h (1 - z^-1) / (1 - p z^-1).

    Args:
        corner: Hz.
        dt: s.

    Returns:
        (3,) h, SCALE g, p.
    """
    w, c = 2.0 * math.pi * corner, 2.0 / dt
    return np.array([c / (c + w), SCALE / (c + w), (c - w) / (c + w)])


@njit
def _motion(coefficients, state, x):
    """One sample of both filters: scaled velocity and displacement."""
    h, g, p = coefficients
    high = h * x + state[0]
    state[0] = p * high - h * x
    velocity = g * high + state[1]
    state[1] = g * high + p * velocity
    shift = g * velocity + state[2]
    state[2] = g * velocity + p * shift
    return velocity, shift


@njit
def _push(line, taps, motion, poles, x, v, s, u):
    """Shift a regressor by one sample."""
    for i in range(taps - 1, 0, -1):
        line[i] = line[i - 1]
    line[0] = x
    at = taps
    if motion:
        line[at] = v
        line[at + 1] = s
        at += 2
    if poles > 0:
        for i in range(at + poles - 1, at, -1):
            line[i] = line[i - 1]
        line[at] = u


@kernel(
    'void(f8[:],f8[:],f8[:],f8[:],f8[:],f8[:],f8[:],i8[:],f8[:],f8[:],f8[:],f8[:,:],f8[:,:],f8[:,:],f8[:],f8[:])',
    '(t),(t),(t),(r),(m),(m),(c),(z),(p),(r),(q),(g,m),(l,d),(l,p)->(t),(t)',
    writable=('voltages', 'before', 'filters', 'motion', 'lines'),
)
def run_line(
    lower,
    applied,
    own,
    reaction,
    num,
    den,
    coefficients,
    sizes,
    weights,
    voltages,
    before,
    filters,
    motion,
    lines,
    reference,
    effect,
):
    """Advance by t samples.

    Args:
        lower: (t) m/s^2 as measured, finite.
        applied: (t) V, the voltage of the sample before, as the guard let it out.
        own: (t) V, what the filter itself gave on the sample before.
        reaction: (r) m/s^2/V, response of the lower sensor to `applied`.
        num, den: (m) G_hat z in z^-1: its delay is counted from the sample that a voltage was computed from, and the
            voltages here are one sample old.
        coefficients: (c) of the motion filters.
        sizes: (taps, motion, poles); not more poles than taps.
        weights: (p) of the filter, of which the last are its poles' c.
        voltages: (r) past of `applied`, newest first, changed.
        before: (2) reference and G_hat own of the sample before, changed.
        filters: (3, m) states of G_hat on applied, reference and own, changed.
        motion: (l, 3) states of the motion filters of x, x_f and, if l is 3, x_g; changed.
        lines: (l, p) phi, phi_f and, if l is 3, phi_g; changed.
        reference: (t) out, x, m/s^2.
        effect: (t) out, G_hat applied, m/s^2: what the voltage does to the upper sensor.
    """
    taps, with_motion, poles = sizes[0], sizes[1], sizes[2]
    for k in range(lower.shape[0]):
        for i in range(voltages.shape[0] - 1, 0, -1):
            voltages[i] = voltages[i - 1]
        voltages[0] = applied[k]
        x = lower[k]
        for i in range(reaction.shape[0]):
            x -= reaction[i] * voltages[i]
        reference[k] = x
        effect[k] = filter_sample(num, den, filters[0], applied[k])
        xf = filter_sample(num, den, filters[1], before[0])
        v, s = _motion(coefficients, motion[0], x)
        vf, sf = _motion(coefficients, motion[1], xf)
        if lines.shape[0] > 2:  # through 1 / (1 - C), whose own past stands in the line
            xg, ug = xf, before[1]
            first = lines.shape[1] - poles
            for i in range(poles):
                xg += weights[first + i] * lines[2, i]
                ug += weights[first + i] * lines[2, first + i]
            vg, sg = _motion(coefficients, motion[2], xg)
            _push(lines[2], taps, with_motion, poles, xg, vg, sg, ug)
        # the regressor of u is one sample old, so its filtered twin is the effect before this sample's
        _push(lines[0], taps, with_motion, poles, x, v, s, own[k])
        _push(lines[1], taps, with_motion, poles, xf, vf, sf, before[1])
        before[0] = x
        before[1] = filter_sample(num, den, filters[2], own[k])


def line_table(taps: int, motion: bool, poles: int, corner: float, dt: float, f: Array) -> Array:
    """Responses of the elements of the regressor, to the reference (the last: to the voltage).

    Args:
        taps, motion, poles: what the line holds.
        corner: Hz, of the motion filters.
        dt: s.
        f: (f,) shares of the sample rate.

    Returns:
        (f, p, 2) real and imaginary parts.
    """
    z = np.exp(-2j * np.pi * f)
    h, g, p = motion_coefficients(corner, dt)
    high, low = h * (1.0 - z) / (1.0 - p * z), g * (1.0 + z) / (1.0 - p * z)
    columns = [z**i for i in range(taps)]
    if motion:
        columns += [high * low, high * low * low]
    columns += [z**i for i in range(1, poles + 1)]
    table = np.stack(columns, axis=-1)
    return np.stack([table.real, table.imag], axis=-1)


def count(taps: int, motion: bool, poles: int) -> int:
    """Number of weights."""
    return taps + 2 * int(motion) + poles


__all__ = ['MOTION', 'SCALE', 'count', 'line_table', 'motion_coefficients', 'run_line']
