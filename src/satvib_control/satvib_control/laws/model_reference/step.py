# SPDX-FileCopyrightText: 2026 The satvib authors
# SPDX-License-Identifier: Apache-2.0
"""One sample of the model reference PID law, for one item: voltage, reference model, sensitivities; see `law`."""

from enum import IntEnum
from typing import NamedTuple

import numpy as np
from satvib_common.arrays import Array
from satvib_common.kernels.compile import kernel
from satvib_common.kernels.deferred import njit
from satvib_common.kernels.direct_form import filter_sample


class Gain(IntEnum):
    """Places of the gains."""

    KP = 0
    KI = 1
    KD = 2


class Loop(IntEnum):
    """Rows of `loop`, polynomials in z^-1 with F = Fb / Fa and D = Db.

    With den = OPEN + K_p P + K_i I + K_d D the loop has G S = P / den and H = (K_p P + K_i I) / den.
    """

    OPEN = 0  # A Fa
    P = 1  # B Fa
    I = 2  # noqa: E741 - B Fb; the field's name
    D = 3  # B Db Fa


class Fixed(IntEnum):
    """Rows of `fixed`, polynomials in z^-1."""

    B = 0
    A = 1
    FB = 2
    FA = 3
    DESIGNED_B = 4  # designed reference model
    DESIGNED_A = 5


class Setting(IntEnum):
    """Places in `settings`."""

    DT = 0  # s; T
    FORGET = 1  # of the powers, per sample
    DESIGNED = 2  # 1: the designed reference model, 0: the identified model closed with WANTED
    LYAPUNOV = (
        3  # the polarity for the Lyapunov rule, whose `eta` are the regressors; 0: sensitivities
    )
    PASS = 4  # pole of the high-pass
    WANTED = 5  # K_i of the reference model


class Filter(IntEnum):
    """Rows of `filters`, states of filters in direct form II transposed."""

    H = 0
    GS_P = 1  # G S for each gain
    GS_I = 2
    GS_D = 3
    PLANT = 4  # of the reference model
    DESIGNED = 5


class Integrator(IntEnum):
    """Rows of `integrators`, the states of F."""

    LAW = 0
    MODEL = 1
    SENSITIVITY = 2


class Last(IntEnum):
    """Places in `last`, values of the sample before."""

    Y = 0  # m/s^2
    PREDICTED = 1  # m/s^2; y_hat
    MODEL_VOLTAGE = 2  # V; of the reference model
    ADAPT = 3  # 1: it was in ADAPT


class HighPass(IntEnum):
    """Columns of `high_pass`; its rows are the three eta and e."""

    IN = 0
    OUT = 1


class Memory(NamedTuple):
    """What is kept from sample to sample; changed in place.

    Attributes:
        gains: (3) K_p, K_i, K_d.
        power: (3) <eta^2> of each.
        integrators: (Integrator, 2).
        last: (Last).
        high_pass: (4, HighPass).
        filters: (Filter, q - 1).
    """

    gains: Array
    power: Array
    integrators: Array
    last: Array
    high_pass: Array
    filters: Array

    @classmethod
    def at_rest(cls, shape: tuple[int, ...], gains: Array, length: int) -> 'Memory':
        """Give the memory of a law that has heard nothing, with its gains (*shape, 3)."""
        return cls(
            gains=gains.copy(),
            power=np.zeros((*shape, 3)),
            integrators=np.zeros((*shape, len(Integrator), 2)),
            last=np.zeros((*shape, len(Last))),
            high_pass=np.zeros((*shape, 4, len(HighPass))),
            filters=np.zeros((*shape, len(Filter), length - 1)),
        )


@njit
def _closed_loop(loop, gains):
    """Numerator and denominator of H (q)."""
    q = loop.shape[1]
    num, den = np.empty(q), np.empty(q)
    for i in range(q):
        num[i] = gains[0] * loop[Loop.P, i] + gains[1] * loop[Loop.I, i]
        den[i] = loop[Loop.OPEN, i] + num[i] + gains[2] * loop[Loop.D, i]
    return num, den


@njit
def _terms(error, output, integrator, last, fixed, settings, memory):
    """What the three gains are multiplied by: the error, its integral, and minus the derivative of the output."""
    fb, fa = fixed[Fixed.FB, :3], fixed[Fixed.FA, :3]
    terms = np.empty(3)
    terms[0] = error
    terms[1] = filter_sample(fb, fa, memory.integrators[integrator], error)
    terms[2] = -(output - memory.last[last]) / settings[Setting.DT]
    memory.last[last] = output
    return terms


@njit
def _reference_model(y, reference, applied, adapt, fixed, settings, memory):
    """Give y_m; outside ADAPT the model follows the applied voltage, so that ADAPT begins where the plant is."""
    last, plant = memory.last, memory.filters[Filter.PLANT]
    voltage = last[Last.MODEL_VOLTAGE] if last[Last.ADAPT] == 1.0 else applied
    filter_sample(fixed[Fixed.B], fixed[Fixed.A], plant, voltage)
    output = plant[0]  # B begins with the delay, so the state holds the next output
    error = reference - (output if adapt == 1.0 else y)
    fb, fa = fixed[Fixed.FB, :3], fixed[Fixed.FA, :3]
    driven = filter_sample(fb, fa, memory.integrators[Integrator.MODEL], error)
    last[Last.MODEL_VOLTAGE] = settings[Setting.WANTED] * driven
    last[Last.ADAPT] = adapt
    designed = filter_sample(
        fixed[Fixed.DESIGNED_B], fixed[Fixed.DESIGNED_A], memory.filters[Filter.DESIGNED], reference
    )
    if adapt != 1.0:
        return 0.0
    return designed if settings[Setting.DESIGNED] == 1.0 else output


@njit
def _without_mean(value, high_pass, pole):
    """High-pass a value."""
    out = pole * (high_pass[HighPass.OUT] + value - high_pass[HighPass.IN])
    high_pass[HighPass.OUT] = out
    high_pass[HighPass.IN] = value
    return out


@kernel(
    'void(f8[:,:],f8[:,:],f8[:],f8[:],f8[:],f8[:],f8[:,:],f8[:],f8[:,:],f8[:,:],f8,f8,f8,f8,'
    'f8[:],f8[:],f8[:],f8[:],f8[:],f8[:])',
    '(l,q),(r,q),(s),(g),(g),(g),(i,t),(k),(h,t),(f,o),(),(),(),()->(),(),(),(g),(),(g)',
    writable=Memory._fields,
)
def pid_step(
    loop, fixed, settings, scale, gains, power, integrators, last, high_pass, filters,
    y, reference, applied, adapt, u, ym, e, eta, e_pass, eta_pass,
):  # fmt: skip
    """Voltage, reference model's output, error, and the derivatives of y with respect to the three gains.

    The adaptation takes error and derivatives without their means, e_pass and eta_pass: a bias in e makes the gain
    swing at the tone's own frequency, and gain times tone is a mean voltage.

    Args:
        loop: (Loop, q).
        fixed: (Fixed, q).
        settings: (Setting).
        scale: (3) 0 where a gain does not adapt (its eta is 0).
        gains, power, integrators, last, high_pass, filters: see `Memory`; gains are not changed here.
        y, reference: m/s^2.
        applied: V; of the sample before.
        adapt: 1 in ADAPT, else 0.
        u, ym, e, eta, e_pass, eta_pass: out.
    """
    memory = Memory(gains, power, integrators, last, high_pass, filters)
    num, den = _closed_loop(loop, gains)
    terms = _terms(reference - y, y, Integrator.LAW, Last.Y, fixed, settings, memory)
    u[0] = gains[0] * terms[0] + gains[1] * terms[1] + gains[2] * terms[2]  # Eq. (35)
    ym[0] = _reference_model(y, reference, applied, adapt, fixed, settings, memory)
    e[0] = y - ym[0]
    predicted = filter_sample(num, den, filters[Filter.H], reference)
    if adapt != 1.0:
        predicted = y
    inputs = _terms(
        reference - predicted, predicted, Integrator.SENSITIVITY, Last.PREDICTED, fixed, settings, memory
    )  # fmt: skip
    for j in range(3):
        eta[j] = 0.0
        if scale[j] != 0.0:
            eta[j] = filter_sample(loop[Loop.P], den, filters[Filter.GS_P + j], inputs[j])
            if settings[Setting.LYAPUNOV] != 0.0:
                eta[j] = settings[Setting.LYAPUNOV] * terms[j]
    for j in range(3):
        eta_pass[j] = _without_mean(eta[j], high_pass[j], settings[Setting.PASS])
        power[j] += settings[Setting.FORGET] * (eta_pass[j] * eta_pass[j] - power[j])
    e_pass[0] = _without_mean(e[0], high_pass[3], settings[Setting.PASS])
