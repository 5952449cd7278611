# SPDX-FileCopyrightText: 2026 The satvib authors
# SPDX-License-Identifier: Apache-2.0
"""The centralized law: a PID controller for each mode of the payload, from all sensors to all voltages.

    q = T^-1 a,    u = -s T (G_d q + G_p H q + G_i H H q),    H(s) = s / (s + w_l)^2

a are the upper accelerations of all struts without bias, q those of the modes (w, alpha, beta; see `strut_geometry`),
H the drift-free integrator of `satvib_common.signals`, G diagonal, s the polarity of the wiring. The controlled
quantity is the velocity of a mode: P is a damper against the sky, I a spring, D a mass.

T^T T is diagonal for struts that are spread evenly, and equal gains for all modes are then the same PID at every
strut: with G_p alone, `velocity_feedback` with a fixed gain.

One missing sensor leaves no mode known: the law gives 0 V to all struts for that sample.
"""

from typing import Any

import numpy as np
from satvib_common.arrays import Array, Mask
from satvib_common.errors import SatvibError
from satvib_common.kernels.compile import kernel
from satvib_common.phases import Phase
from satvib_common.signals.integrator import leaky_integrator
from satvib_common.struts import mode_matrix, strut_matrix

from satvib_control.laws.base import BasicLaw, LawInput
from satvib_control.laws.centralized.parameters import CentralizedParameters
from satvib_control.laws.reasons import reason

BLIND = reason('0 V: the upper acceleration of a strut is missing, so no mode is known')


@kernel(
    'void(f8[:,:],f8[:,:],f8[:,:],f8[:,:],f8[:,:],f8[:],f8[:])',
    '(n,n),(n,n),(g,n),(c,t),(n,s),(n)->(n)',
    writable=('state',),
)
def modal_step(
    strut: Any, mode: Any, gains: Any, integrator: Any, state: Any, y: Any, u: Any
) -> None:
    """One sample of all struts of one item.

    Args:
        strut: T.
        mode: T^-1.
        gains: rows P, I, D.
        integrator: rows b and a of H.
        state: per mode two states of each of the two integrators.
        y: m/s^2.
        u: V.
    """
    n = y.shape[0]
    b, a = integrator[0], integrator[1]
    for i in range(n):
        u[i] = 0.0
    for m in range(n):
        q = 0.0
        for i in range(n):
            q += mode[m, i] * y[i]
        v = b[0] * q + state[m, 0]
        state[m, 0] = state[m, 1] + b[1] * q - a[1] * v
        state[m, 1] = b[2] * q - a[2] * v
        x = b[0] * v + state[m, 2]
        state[m, 2] = state[m, 3] + b[1] * v - a[1] * x
        state[m, 3] = b[2] * v - a[2] * x
        wanted = gains[0, m] * v + gains[1, m] * x + gains[2, m] * q
        for i in range(n):
            u[i] -= strut[i, m] * wanted


class Centralized(BasicLaw[CentralizedParameters]):
    """The law on the last axis of `shape`, which counts all struts; see the module's page.

    Raises:
        SatvibError: parameters of a single strut's controller, or a shape without all struts.
    """

    def __init__(
        self, parameters: CentralizedParameters, dt: float, shape: tuple[int, ...] = ()
    ) -> None:
        p = parameters
        if not isinstance(p, CentralizedParameters) or shape[-1:] != (p.struts,):
            raise SatvibError(
                'law: centralized needs all struts at once; set scheme: centralized in the scenario'
            )
        super().__init__(p, dt, shape)
        n, s = p.struts, p.velocity_polarity
        angles = p.strut_angles[:n]
        self._strut, self._mode = strut_matrix(angles), mode_matrix(angles)
        self._gains = s * np.array([p.gains_p[:n], p.gains_i[:n], p.gains_d[:n]])
        self._integrator = np.array(leaky_integrator(p.velocity_corner, dt))
        self._state = np.zeros((*shape, 4))
        # what people see of a strut: the gains from its own sensor to its own voltage
        own = [
            np.array([sum(self._strut[i] * row * self._mode[:, i]) for i in range(n)])
            for row in self._gains
        ]
        self.state.ki = np.broadcast_to(own[0], shape)
        self.state.kp = np.broadcast_to(own[2], shape)

    def step(self, x: LawInput, phase: Phase) -> Array:  # noqa: ARG002 - the same in every phase
        """Give the voltages (shape, V)."""
        known = np.broadcast_to(np.all(x.valid, axis=-1, keepdims=True), self.shape)
        y = np.where(known, x.upper, 0.0)
        u = modal_step(self._strut, self._mode, self._gains, self._integrator, self._state, y)
        self.state.reason = np.where(known, 0, BLIND)
        return np.where(known, u, 0.0)

    def reset(self, mask: Mask | bool = True) -> None:
        """Empty the integrators of all struts of an item where `mask` holds for any of them."""
        any_of = np.any(np.broadcast_to(np.asarray(mask), self.shape), axis=-1)
        self._state[...] = np.where(any_of[..., None, None], 0.0, self._state)
