# SPDX-FileCopyrightText: 2026 The satvib authors
# SPDX-License-Identifier: Apache-2.0
"""The largest sensitivity of a set of resonators on a model, watched as they move.

For frozen frequencies w_i and paces n_i of the tones the law is linear. With g_i = 2 / n_i, k_i = 1 / G(w_i) and

    R_i(k; z) = (k / (1 - e^{j w_i} z^-1) + k* / (1 - e^{-j w_i} z^-1)) / 2,

the tracker of `tracker` and u = -sum Re(k_i x_i) are the Youla parameter

    Q = sum g_i R_i(k_i) / (1 + sum g_i (R_i(1) - 1)),    u = -Q (y - G u),    S = 1 - G Q.

S is 0 at every w_i, and 1 / max |S| is the modulus margin of the loop. The maximum is taken over the points of
`margin_grid`: a uniform grid, and the angles of the model's poles and zeros, where its response turns quickly.
Where it exceeds the limit all paces are stretched. They shrink again once there is room. While a tone is being
caught (its memory still below six wanted paces) twice the limit is allowed.

In a sum with other loops (`laws.sum`) the sensitivities multiply: |S| counts times that of the partners. Where they
are below 1 it counts as it is, because the model is not better there.
"""

import math

import numpy as np
from satvib_common.arrays import Array
from satvib_common.kernels.deferred import njit

from satvib_control.laws.narrowband.memory import Backoff, Point, Setting, Tone, Tracking
from satvib_control.laws.narrowband.model_correction import factor
from satvib_control.laws.narrowband.tracker import PACES
from satvib_control.model_analysis.transfer import respond

UNIFORM = 96  # points of the uniform grid
MOST = 1e3  # largest stretch
SLOWER, FASTER = 1.1, 1.03  # factors on the stretch at each look: more caution than haste
ROOM = 0.97  # of the limit, below which paces shrink again


@njit
def largest_sensitivity(tones, inverse, points, correction):
    """Max |S| over the points.

    Args:
        tones: (tones, Tone); those with an effect (FADE above 0) count.
        inverse: (tones) complex; what the law multiplies x by, k_i.
        points: (q, Point).
        correction: (Correction) of the model.
    """
    worst = 0.0
    for q in range(points.shape[0]):
        omega = points[q, Point.OMEGA]
        if _on_a_tone(tones, omega):
            continue  # S is 0
        q_top, q_bottom = _youla_parameter(tones, inverse, omega)
        response = complex(points[q, Point.RE], points[q, Point.IM]) * factor(correction, omega)
        partners = points[q, Point.PARTNERS]
        worst = max(worst, partners * abs(1.0 - response * q_top / q_bottom))
    return worst


@njit
def _on_a_tone(tones, omega):
    for i in range(tones.shape[0]):
        if tones[i, Tone.ON] == 0.0 or tones[i, Tone.PACE] == 0.0:
            continue
        if abs(omega - tones[i, Tone.OMEGA]) < 1e-6:
            return True
    return False


@njit
def _youla_parameter(tones, inverse, omega):
    """Numerator and denominator of Q at a frequency (rad/sample)."""
    z = complex(math.cos(omega), -math.sin(omega))
    top = 0.0j
    bottom = 1.0 + 0.0j
    for i in range(tones.shape[0]):
        t = tones[i]
        if t[Tone.ON] == 0.0 or t[Tone.PACE] == 0.0:
            continue
        turn = complex(math.cos(t[Tone.OMEGA]), math.sin(t[Tone.OMEGA]))
        first = 1.0 / (1.0 - turn * z)
        second = 1.0 / (1.0 - turn.conjugate() * z)
        g = 1.0 / t[Tone.PACE]
        if t[Tone.FADE] > 0.0:
            k = inverse[i]
            top += g * (k * first + k.conjugate() * second)
        bottom += g * (first + second - 2.0)
    return top, bottom


@njit
def stretch(design, memory, inverse):
    """Slow the tones down, or make them faster again, so that max |S| stays below the limit."""
    settings, tracking, tones = design.settings, memory.tracking, memory.tones
    worst = largest_sensitivity(tones, inverse, design.points, memory.correction)
    tracking[Tracking.SENSITIVITY] = worst
    limit = settings[Setting.SENSITIVITY]
    for i in range(tones.shape[0]):
        caught = tones[i, Tone.MEMORY] >= PACES * settings[Setting.PACE]
        if tones[i, Tone.ON] > 0.0 and not caught:
            limit = 2.0 * settings[Setting.SENSITIVITY]
    now, least = tracking[Tracking.STRETCH], memory.backoff[Backoff.SLOW]
    if worst > limit:
        tracking[Tracking.STRETCH] = min(now * SLOWER, MOST)
    elif worst < ROOM * limit and now > least:
        tracking[Tracking.STRETCH] = max(now / FASTER, least)


def margin_grid(b: Array, a: Array) -> Array:
    """Give the points at which |S| is watched, for each item its own.

    Args:
        b, a: (..., p) polynomials of the model in z^-1.

    Returns:
        (..., q, Point).
    """
    shape = b.shape[:-1]
    uniform = (np.arange(UNIFORM) + 0.5) * math.pi / UNIFORM
    size = UNIFORM + 3 * (b.shape[-1] + a.shape[-1])
    out = np.zeros((*shape, size, len(Point)))
    for i in np.ndindex(shape):
        turns = _turns(b[i]) + _turns(a[i])
        points = np.full(size, uniform[0])
        points[:UNIFORM] = uniform
        points[UNIFORM : UNIFORM + len(turns)] = np.clip(turns, 1e-4, math.pi)
        for q, omega in enumerate(points):
            response = respond(b[i], a[i], omega) if np.all(np.isfinite(a[i])) else 0.0j
            out[(*i, q)] = omega, response.real, response.imag, 1.0
    return out


def _turns(polynomial: Array) -> list[float]:
    """Angles (rad/sample) at the roots of a polynomial, and on both sides of them."""
    kept = np.trim_zeros(polynomial)
    if len(kept) < 2 or not np.all(np.isfinite(kept)):
        return []
    found: list[float] = []
    for root in np.roots(kept):
        width = min(abs(1.0 - abs(root)), 0.1)
        angle = abs(math.atan2(root.imag, root.real))
        found += [angle - width, angle, angle + width]
    return found
