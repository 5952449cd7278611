# SPDX-FileCopyrightText: 2026 The satvib authors
# SPDX-License-Identifier: Apache-2.0
"""The designed reference model: what an ideal skyhook damper makes of the identified mode.

A mode zeta_0, w with the damping raised to zeta_m by K answers the reference u_c with

    H_m(s) = (1 - zeta_0 / zeta_m) 2 zeta_m w s / (s^2 + 2 zeta_m w s + w^2),

sampled by Tustin's rule with the frequency w kept, and late by the model's input delay.
"""

import math

import numpy as np
from satvib_common.arrays import Array, Complex
from satvib_ident.models.iir_model import IirModel


def designed_model(model: IirModel, w: float, damping: float, poles: Complex) -> Array:
    """Give numerator and denominator in z^-1, (*shape, 2, 3 + delay).

    Args:
        model: the identified model, for the delay and T.
        w: rad/s; 0 for the model's own.
        damping: zeta_m.
        poles: shape, rad/s; the model's dominant pole, for zeta_0.
    """
    out = np.zeros((*poles.shape, 2, 3 + model.delay))
    for i in np.ndindex(poles.shape):
        s = complex(poles[i])
        own = abs(s) or 1.0
        zeta = max(-s.real / own, 0.0)
        speed = min(w or own, 0.95 * math.pi / model.dt)
        gain = max(1.0 - zeta / damping, 0.0)
        c = speed / math.tan(0.5 * speed * model.dt)  # s = c (1 - z^-1) / (1 + z^-1)
        cross = 2.0 * damping * speed * c
        first = c * c + cross + speed * speed
        out[i][0, model.delay :] = [gain * cross / first, 0.0, -gain * cross / first]
        out[i][1, :3] = [
            1.0,
            2.0 * (speed * speed - c * c) / first,
            (c * c - cross + speed * speed) / first,
        ]
    return out
