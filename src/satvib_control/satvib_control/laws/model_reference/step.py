# SPDX-FileCopyrightText: 2026 The satvib authors
# SPDX-License-Identifier: Apache-2.0
"""One sample of the model reference PID law, for one item: the inner loop of `model_reference`.

Polynomials in z^-1 (rows of `loop`): 0 A Fa, 1 B Fa, 2 B Fb, 3 B Db Fa with D = Db, so that

    den = row0 + K_p row1 + K_i row2 + K_d row3,    G S = row1 / den,    H = (K_p row1 + K_i row2) / den.

`fixed`: 0 B, 1 A, 2 Fb, 3 Fa, 4 and 5 numerator and denominator of a designed reference model.
`filters`: states of 0 H, 1-3 G S for each gain, 4 the reference model's plant, 5 the designed reference model.
`memory`: places are named below.
"""

from typing import Any

import numpy as np
from satvib_common.kernels.compile import kernel
from satvib_common.kernels.direct_form import filter_sample

# places in `memory`
GAIN = 0  # K_p, K_i, K_d
POWER = 3  # their gradients' powers
WANTED = 6  # K_i of the reference model
F_LAW, F_MODEL, F_SENSE = 7, 9, 11  # two states of F each
Y_LAST, P_LAST, U_MODEL, WAS_ADAPT = 13, 14, 15, 16
PASS_IN, PASS_OUT = 17, 21  # the high-pass of e and of the three eta
MEMORY = 25


@kernel(
    'void(f8[:,:],f8[:,:],f8[:],f8[:],f8[:],f8[:,:],f8,f8,f8,f8,f8[:],f8[:],f8[:],f8[:],f8[:],f8[:])',
    '(l,q),(r,q),(s),(g),(k),(t,o),(),(),(),()->(),(),(),(g),(),(g)',
    writable=('memory', 'filters'),
)
def pid_step(
    loop: Any,
    fixed: Any,
    settings: Any,
    scale: Any,
    memory: Any,
    filters: Any,
    y: Any,
    reference: Any,
    applied: Any,
    adapt: Any,
    u: Any,
    ym: Any,
    e: Any,
    eta: Any,
    e_pass: Any,
    eta_pass: Any,
) -> None:
    """Voltage, reference model's output, error, and the derivatives of y with respect to the three gains.

    The adaptation takes both without their mean, e_pass and eta_pass: a bias in e makes the gain swing at the tone's
    own frequency, and gain times tone is a mean voltage.

    settings: T, forgetting of the powers per sample, 1 for the designed reference model, 0 for sensitivities or the
    polarity for the Lyapunov rule, whose `eta` are the regressors, and the pole of the high-pass.
    scale: 0 where a gain does not adapt (eta is 0).
    `adapt`: 1 in ADAPT, else 0.
    """
    q = loop.shape[1]
    kp, ki, kd = memory[0], memory[1], memory[2]
    den = np.empty(q)
    num = np.empty(q)
    for i in range(q):
        num[i] = kp * loop[1, i] + ki * loop[2, i]
        den[i] = loop[0, i] + num[i] + kd * loop[3, i]
    fb, fa = fixed[2, :3], fixed[3, :3]
    dt = settings[0]

    # the law, Eq. (35)
    x = np.empty(3)
    x[0] = reference - y
    x[1] = filter_sample(fb, fa, memory[F_LAW : F_LAW + 2], reference - y)
    x[2] = -(y - memory[Y_LAST]) / dt
    memory[Y_LAST] = y
    u[0] = kp * x[0] + ki * x[1] + kd * x[2]

    # the reference model; outside ADAPT it follows the applied voltage, so that ADAPT begins where the plant is
    filter_sample(
        fixed[0], fixed[1], filters[4], memory[U_MODEL] if memory[WAS_ADAPT] == 1.0 else applied
    )
    output = filters[4, 0]  # B begins with the delay, so the state holds the next output
    driven = filter_sample(
        fb, fa, memory[F_MODEL : F_MODEL + 2], reference - (output if adapt == 1.0 else y)
    )
    memory[U_MODEL] = memory[WANTED] * driven
    memory[WAS_ADAPT] = adapt
    designed = filter_sample(fixed[4], fixed[5], filters[5], reference)
    predicted = filter_sample(num, den, filters[0], reference)
    ym[0] = 0.0
    if adapt == 1.0:
        ym[0] = designed if settings[2] == 1.0 else output
    else:
        predicted = y
    e[0] = y - ym[0]

    # sensitivities: G S filtered eps, F eps, -D y_hat
    s = np.empty(3)
    s[0] = reference - predicted
    s[1] = filter_sample(fb, fa, memory[F_SENSE : F_SENSE + 2], reference - predicted)
    s[2] = -(predicted - memory[P_LAST]) / dt
    memory[P_LAST] = predicted
    for j in range(3):
        eta[j] = 0.0
        if scale[j] != 0.0:
            eta[j] = filter_sample(loop[1], den, filters[1 + j], s[j])
            if settings[3] != 0.0:
                eta[j] = settings[3] * x[j]
    for j in range(4):
        now = e[0] if j == 3 else eta[j]
        memory[PASS_OUT + j] = settings[4] * (memory[PASS_OUT + j] + now - memory[PASS_IN + j])
        memory[PASS_IN + j] = now
        if j < 3:
            eta_pass[j] = memory[PASS_OUT + j]
            memory[POWER + j] += settings[1] * (eta_pass[j] * eta_pass[j] - memory[POWER + j])
    e_pass[0] = memory[PASS_OUT + 3]
