# SPDX-FileCopyrightText: 2026 The satvib authors
# SPDX-License-Identifier: Apache-2.0
"""What an attempt of law narrowband teaches about the plant at the tone.

From the first voltage of an attempt on, y and v, the effect that the model believes in, are turned back by the tone's
frequency of that moment, w, and smoothed over a pace:

    Y = D s + rho V,        s the smoothed 1,

D being the tone without control and rho the true response over the believed one. Least squares with a memory of 20
paces give both. v comes out of the model, so the dynamics of the plant are in V as they are in Y. When the attempt was
taken back because it was loud and proved guilty (`tone_watch`), and V explains half of what D does not, the model is
corrected by rho at w, with one coefficient more:

    G <- G (f_0 + f_1 z^-1),    f_1 = -Im rho / sin w,    f_0 = Re rho - f_1 cos w.

A model out by 68 to 80 degrees does not make it loud: frequency and phase chase each other until the tracker is lost,
finds something in what the voltage has left behind, and so on. But w is what it was when the attempt began, after
quiet, so rho is known all the better. An attempt is taken back as `turned` when the tracker is lost, the strongest
tone has strayed by 3 %, V explains nine tenths of what D does not, and rho is out by more than 60 degrees.

An attempt at another frequency, a third away or more, begins with the model as it was: right after a pause a frequency
is not known any better. Where the pause ends with such a frequency the tone itself has moved, D was no constant, and
nothing was taught. Smoothing over half a pace or four, asking for more than half, or a tenth in the place of the
third left more of the drawn rigs without a lesson (benchmarks/robustness.py). What did nothing teaches nothing: there
the drift of a frequency that is not quite known looks like an effect.
"""

import math

import numpy as np
from numba import njit

from satvib_control.laws.narrowband.tracker import WANTED

# places in the lesson
FIX_0, FIX_1, FIXED_AT, LAST, OMEGA, STRAYED, TURN, ONE = range(8)
Y_RE, Y_IM, V_RE, V_IM = range(8, 12)
SS, SV_RE, SV_IM, SY_RE, SY_IM, VV, VY_RE, VY_IM, YY = range(12, 21)
LESSON = 21
UNTAUGHT = np.eye(LESSON)[FIX_0]

SMOOTH, REMEMBER = 1.0, 20.0  # paces
EXPLAINED, CLEARLY = 0.5, 0.9
LEAST, MOST = 0.2, 5.0  # size of the whole correction
FAR, MOVED = 0.3, 0.03


@njit
def correction(lesson, omega):
    """By what the response of the model is multiplied at a frequency (rad/sample)."""
    return lesson[FIX_0] + lesson[FIX_1] * complex(math.cos(omega), -math.sin(omega))


@njit
def taps(rho, omega):
    """f_0 and f_1 of the filter whose response at a frequency (rad/sample) is rho."""
    f_1 = -rho.imag / math.sin(omega)
    return rho.real - f_1 * math.cos(omega), f_1


@njit
def corrected(lesson, v):
    """The effect of the voltage, from what the model says of it."""
    effect = lesson[FIX_0] * v + lesson[FIX_1] * lesson[LAST]
    lesson[LAST] = v
    return effect


@njit
def forget(lesson):
    """Take the model as it was."""
    lesson[FIX_0], lesson[FIX_1], lesson[FIXED_AT] = 1.0, 0.0, 0.0


@njit
def _apart(one, other):
    """Whether two frequencies are those of different tones."""
    return abs(one - other) > FAR * min(one, other)


@njit
def attend(lesson, omega):
    """An attempt begins at the frequency (rad/sample)."""
    if _apart(omega, lesson[FIXED_AT]):
        forget(lesson)
    lesson[OMEGA] = omega
    lesson[STRAYED:] = 0.0


@njit
def fresh(lesson):
    """Whether there was no attempt yet."""
    return lesson[OMEGA] == 0.0


@njit
def learn(lesson, settings, omega, y, effect):
    """Take a sample of an attempt.

    Args:
        lesson: changed.
        settings: of the law.
        omega: rad/sample, of the strongest tone; 0 while none is tracked.
        y: m/s^2.
        effect: m/s^2, what the model believes that the voltage does to y.
    """
    if omega > 0.0:
        lesson[STRAYED] = max(lesson[STRAYED], abs(omega - lesson[OMEGA]))
    turn = lesson[TURN]
    c, s = math.cos(turn), -math.sin(turn)
    lesson[TURN] = (turn + lesson[OMEGA]) % (2.0 * math.pi)
    share = 1.0 / (SMOOTH * settings[WANTED])
    lesson[ONE] += (1.0 - lesson[ONE]) * share
    lesson[Y_RE] += (y * c - lesson[Y_RE]) * share
    lesson[Y_IM] += (y * s - lesson[Y_IM]) * share
    lesson[V_RE] += (effect * c - lesson[V_RE]) * share
    lesson[V_IM] += (effect * s - lesson[V_IM]) * share
    one, yr, yi, vr, vi = lesson[ONE], lesson[Y_RE], lesson[Y_IM], lesson[V_RE], lesson[V_IM]
    lesson[SS:] *= 1.0 - 1.0 / (REMEMBER * settings[WANTED])
    lesson[SS] += one * one
    lesson[SV_RE] += one * vr
    lesson[SV_IM] += one * vi
    lesson[SY_RE] += one * yr
    lesson[SY_IM] += one * yi
    lesson[VV] += vr * vr + vi * vi
    lesson[VY_RE] += vr * yr + vi * yi
    lesson[VY_IM] += vr * yi - vi * yr
    lesson[YY] += yr * yr + yi * yi


@njit
def _ratio(lesson):
    """The true response over the believed one, and how much it explains of what D s leaves of Y."""
    ss, vv, yy = lesson[SS], lesson[VV], lesson[YY]
    if ss == 0.0:
        return 1.0 + 0.0j, 0.0
    sv = complex(lesson[SV_RE], lesson[SV_IM])
    sy = complex(lesson[SY_RE], lesson[SY_IM])
    vy = complex(lesson[VY_RE], lesson[VY_IM])
    excited = vv - abs(sv) ** 2 / ss
    unexplained = yy - abs(sy) ** 2 / ss
    common = vy - sv.conjugate() * sy / ss
    if excited <= 1e-9 * vv or unexplained <= 0.0:
        return 1.0 + 0.0j, 0.0
    return common / excited, abs(common) ** 2 / (excited * unexplained)


@njit
def turned(lesson):
    """Whether the attempt took the frequency along and shows clearly that the model is out by more than 60 degrees."""
    if lesson[STRAYED] <= MOVED * lesson[OMEGA]:
        return False
    ratio, share = _ratio(lesson)
    return share > CLEARLY and ratio.real < 0.5 * abs(ratio)


@njit
def conclude(lesson, heard):
    """Correct the model by what the attempt taught, if it taught anything; whether it did.

    Args:
        lesson: changed.
        heard: rad/sample, of the strongest tone at the end of the pause; 0 where there is none.
    """
    omega = lesson[OMEGA]
    ratio, share = _ratio(lesson)
    if share < EXPLAINED or (heard > 0.0 and _apart(heard, omega)):
        return False
    rho = ratio * correction(lesson, omega)
    size = abs(rho)
    rho *= min(max(size, LEAST), MOST) / size
    lesson[FIX_0], lesson[FIX_1] = taps(rho, omega)
    lesson[FIXED_AT] = omega
    return True
