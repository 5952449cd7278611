# SPDX-FileCopyrightText: 2026 The satvib authors
# SPDX-License-Identifier: Apache-2.0
"""How law narrowband corrects its model at a tone, after an attempt that failed.

An attempt begins with the first voltage after quiet. From then on y and v, the effect of the voltage in the model, are
turned back by the frequency w that the tone had at that moment, and smoothed over a pace:

    Y = D s + rho V,        s the smoothed 1.

D is the tone without control, rho the true response over that of the model. Least squares with a memory of 20 paces
give both. v comes out of the model, so V has the dynamics of the plant as Y has. The model is corrected by rho at w
when three things hold: the attempt was held because it was loud, the law was the cause (`backoff`), and V explains half
of what D does not. The correction has one more coefficient:

    G <- G (f_0 + f_1 z^-1),    f_1 = -Im rho / sin w,    f_0 = Re rho - f_1 cos w.

A model that is wrong by 68 to 80 degrees does not make the vibration loud. Frequency and phase chase each other until
the tracker is lost, finds something in what the voltage has left behind, and so on. But w was measured when the attempt
began, after quiet, so rho is known all the better. An attempt is held as `turned` when the tracker is lost, the
strongest tone has strayed by 3 %, V explains nine tenths of what D does not, and rho is wrong by more than 60 degrees.

An attempt at another frequency, a third away or more, begins with the model as it was identified: right after a hold a
frequency is not known any better. Where the hold ends with such a frequency the tone itself has moved, D was no
constant, and the model is not corrected. Other choices left more of the drawn rigs without a correction
(benchmarks/robustness.py): smoothing over half a pace or four, asking for more than half, a tenth in the place of the
third. An attempt without effect gives no correction: the drift of a frequency that is not quite known looks like one.
"""

import math

from satvib_common.kernels.deferred import njit

from satvib_control.laws.narrowband.memory import Correction, Setting

SMOOTH = 1.0  # paces over which Y and V are smoothed: half a pace or four were worse
REMEMBER = 20.0  # paces of memory of the least squares
EXPLAINED = 0.5  # share of V in what D does not explain, for a correction
CLEARLY = 0.9  # the same for `turned`, where the vibration is not loud
SMALLEST, LARGEST = 0.2, 5.0  # size of the whole correction
APART = 0.3  # of the frequency: another tone
STRAYED = 0.03  # of the frequency, for `turned`: an attempt at the right frequency stays within


@njit
def factor(correction, omega):
    """By what the response of the model is multiplied at a frequency (rad/sample)."""
    turn = complex(math.cos(omega), -math.sin(omega))
    return correction[Correction.F_0] + correction[Correction.F_1] * turn


@njit
def taps(rho, omega):
    """f_0 and f_1 of the filter whose response at a frequency (rad/sample) is rho."""
    f_1 = -rho.imag / math.sin(omega)
    return rho.real - f_1 * math.cos(omega), f_1


@njit
def corrected(correction, effect):
    """Give the effect of the voltage (m/s^2) from that of the model without correction."""
    last = correction[Correction.LAST_EFFECT]
    correction[Correction.LAST_EFFECT] = effect
    return correction[Correction.F_0] * effect + correction[Correction.F_1] * last


@njit
def no_attempt(correction):
    """Whether there was no attempt yet."""
    return correction[Correction.OMEGA] == 0.0


@njit
def begin_attempt(correction, omega):
    """An attempt begins at the frequency (rad/sample)."""
    if _apart(omega, correction[Correction.CORRECTED_AT]):
        correction[Correction.F_0], correction[Correction.F_1] = 1.0, 0.0
        correction[Correction.CORRECTED_AT] = 0.0
    correction[Correction.OMEGA] = omega
    correction[Correction.STRAYED :] = 0.0


@njit
def learn(correction, settings, omega, y, effect):
    """Take a sample of an attempt.

    Args:
        correction: changed.
        settings: of the law.
        omega: rad/sample; of the strongest tone; 0 while none is tracked.
        y: m/s^2.
        effect: m/s^2; what the voltage does to y in the model.
    """
    if omega > 0.0:
        away = abs(omega - correction[Correction.OMEGA])
        correction[Correction.STRAYED] = max(correction[Correction.STRAYED], away)
    _smooth(correction, 1.0 / (SMOOTH * settings[Setting.PACE]), y, effect)
    correction[Correction.SS :] *= 1.0 - 1.0 / (REMEMBER * settings[Setting.PACE])
    _add_products(correction)


@njit
def _smooth(correction, share, y, effect):
    """Turn y and the effect back by the angle of this sample and smooth them."""
    turn = correction[Correction.TURN]
    c, s = math.cos(turn), -math.sin(turn)
    correction[Correction.TURN] = (turn + correction[Correction.OMEGA]) % (2.0 * math.pi)
    for slot, value in (
        (Correction.ONE, 1.0),
        (Correction.Y_RE, y * c),
        (Correction.Y_IM, y * s),
        (Correction.V_RE, effect * c),
        (Correction.V_IM, effect * s),
    ):
        correction[slot] += (value - correction[slot]) * share


@njit
def _add_products(correction):
    """Add this sample to the sums of the least squares."""
    one = correction[Correction.ONE]
    yr, yi = correction[Correction.Y_RE], correction[Correction.Y_IM]
    vr, vi = correction[Correction.V_RE], correction[Correction.V_IM]
    correction[Correction.SS] += one * one
    correction[Correction.SV_RE] += one * vr
    correction[Correction.SV_IM] += one * vi
    correction[Correction.SY_RE] += one * yr
    correction[Correction.SY_IM] += one * yi
    correction[Correction.VV] += vr * vr + vi * vi
    correction[Correction.VY_RE] += vr * yr + vi * yi
    correction[Correction.VY_IM] += vr * yi - vi * yr
    correction[Correction.YY] += yr * yr + yi * yi


@njit
def _ratio(correction):
    """The true response over that of the model, and how much it explains of what D s leaves of Y."""
    ss, vv, yy = correction[Correction.SS], correction[Correction.VV], correction[Correction.YY]
    if ss == 0.0:
        return 1.0 + 0.0j, 0.0
    sv = complex(correction[Correction.SV_RE], correction[Correction.SV_IM])
    sy = complex(correction[Correction.SY_RE], correction[Correction.SY_IM])
    vy = complex(correction[Correction.VY_RE], correction[Correction.VY_IM])
    excited = vv - abs(sv) ** 2 / ss
    unexplained = yy - abs(sy) ** 2 / ss
    common = vy - sv.conjugate() * sy / ss
    if excited <= 1e-9 * vv or unexplained <= 0.0:
        return 1.0 + 0.0j, 0.0
    return common / excited, abs(common) ** 2 / (excited * unexplained)


@njit
def turned(correction):
    """Whether the frequency strayed in the attempt, and it shows clearly that the model is wrong by over 60 degrees."""
    if correction[Correction.STRAYED] <= STRAYED * correction[Correction.OMEGA]:
        return False
    ratio, share = _ratio(correction)
    return share > CLEARLY and ratio.real < 0.5 * abs(ratio)


@njit
def correct_model(correction, heard):
    """Correct the model by what the attempt has shown, if it has shown anything; give whether it has.

    Args:
        correction: changed.
        heard: rad/sample; of the strongest tone at the end of the hold; 0 where there is none.
    """
    omega = correction[Correction.OMEGA]
    ratio, share = _ratio(correction)
    if share < EXPLAINED or (heard > 0.0 and _apart(heard, omega)):
        return False
    rho = ratio * factor(correction, omega)
    size = abs(rho)
    rho *= min(max(size, SMALLEST), LARGEST) / size
    correction[Correction.F_0], correction[Correction.F_1] = taps(rho, omega)
    correction[Correction.CORRECTED_AT] = omega
    return True


@njit
def _apart(one, other):
    """Whether two frequencies are those of different tones."""
    return abs(one - other) > APART * min(one, other)
