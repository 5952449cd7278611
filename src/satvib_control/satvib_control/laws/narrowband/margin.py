# SPDX-FileCopyrightText: 2026 The satvib authors
# SPDX-License-Identifier: Apache-2.0
"""The largest sensitivity of a set of resonators on a model, watched as they move.

With the tones' frequencies w_i and paces n_i as they stand, the law is linear. With g_i = 2 / n_i, k_i = 1 / G(w_i)
and

    R_i(k; z) = (k / (1 - e^{j w_i} z^-1) + k* / (1 - e^{-j w_i} z^-1)) / 2,

the tracker of `tone_tracker` and u = -sum Re(k_i x_i) are the Youla parameter

    Q = sum g_i R_i(k_i) / (1 + sum g_i (R_i(1) - 1)),    u = -Q (y - G u),    S = 1 - G Q.

S is 0 at every w_i, and 1 / max |S| is the modulus margin of the loop. The maximum is taken over the points of
`margin_grid`: a uniform grid, and the angles of the model's poles and zeros, where its response turns quickly.
Where it exceeds the limit all paces are stretched, and let go again once there is room. While a tone is being
caught (its memory still below six wanted paces) twice the limit is allowed.
"""

import math

import numpy as np
from numba import njit
from satvib_common.arrays import Array

from satvib_control.laws.narrowband.model_correction import correction
from satvib_control.laws.narrowband.tracker import (
    FADE,
    MEMORY,
    OMEGA,
    ON,
    PACE,
    PEAK,
    SENSITIVITY,
    SLOW,
    STRETCH,
    WANTED,
)
from satvib_control.model_analysis.transfer import respond

UNIFORM = 96


@njit
def largest_sensitivity(tones, inverse, points, lesson):
    """Max |S| over the points.

    Args:
        tones: (tones, TONE); those with an effect (FADE above 0) count.
        inverse: (tones) complex; what the law multiplies x by, k_i.
        points: (q, 3) omega, Re G, Im G.
    """
    worst = 0.0
    for q in range(points.shape[0]):
        omega = points[q, 0]
        z = complex(math.cos(omega), -math.sin(omega))
        top = 0.0j
        bottom = 1.0 + 0.0j
        near = False
        for i in range(tones.shape[0]):
            t = tones[i]
            if t[ON] == 0.0 or t[PACE] == 0.0:
                continue
            if abs(omega - t[OMEGA]) < 1e-6:
                near = True
                break
            turn = complex(math.cos(t[OMEGA]), math.sin(t[OMEGA]))
            first = 1.0 / (1.0 - turn * z)
            second = 1.0 / (1.0 - turn.conjugate() * z)
            g = 1.0 / t[PACE]
            if t[FADE] > 0.0:
                k = inverse[i]
                top += g * (k * first + k.conjugate() * second)
            bottom += g * (first + second - 2.0)
        if not near:
            response = complex(points[q, 1], points[q, 2]) * correction(lesson, omega)
            worst = max(worst, abs(1.0 - response * top / bottom))
    return worst


@njit
def stretch(tones, inverse, points, lesson, settings, common):
    """Slow the tones down, or let them go again, so that max |S| stays below the limit."""
    worst = largest_sensitivity(tones, inverse, points, lesson)
    common[SENSITIVITY] = worst
    limit = settings[PEAK]
    for i in range(tones.shape[0]):
        if tones[i, ON] > 0.0 and tones[i, MEMORY] < 6.0 * settings[WANTED]:
            limit = 2.0 * settings[PEAK]
    if worst > limit:
        common[STRETCH] = min(common[STRETCH] * 1.1, 1e3)
    elif worst < 0.97 * limit and common[STRETCH] > common[SLOW]:
        common[STRETCH] = max(common[STRETCH] / 1.03, common[SLOW])


def margin_grid(b: Array, a: Array) -> Array:
    """Give the points at which |S| is watched, for each item its own.

    Args:
        b, a: (..., p) polynomials of the model in z^-1.

    Returns:
        (..., q, 3) omega (rad/sample), Re G, Im G.
    """
    shape = b.shape[:-1]
    uniform = (np.arange(UNIFORM) + 0.5) * math.pi / UNIFORM
    size = UNIFORM + 3 * (b.shape[-1] + a.shape[-1])
    out = np.zeros((*shape, size, 3))
    for i in np.ndindex(shape):
        extra: list[float] = []
        for c in (b[i], a[i]):
            kept = np.trim_zeros(c)
            if len(kept) < 2 or not np.all(np.isfinite(kept)):
                continue
            for root in np.roots(kept):
                width = min(abs(1.0 - abs(root)), 0.1)
                angle = abs(math.atan2(root.imag, root.real))
                extra += [angle - width, angle, angle + width]
        points = np.full(size, uniform[0])
        points[:UNIFORM] = uniform
        points[UNIFORM : UNIFORM + len(extra)] = np.clip(extra, 1e-4, math.pi)
        for q, omega in enumerate(points):
            response = respond(b[i], a[i], omega) if np.all(np.isfinite(a[i])) else 0.0j
            out[(*i, q)] = omega, response.real, response.imag
    return out
