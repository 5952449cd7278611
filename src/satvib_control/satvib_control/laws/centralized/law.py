# SPDX-FileCopyrightText: 2026 The satvib authors
# SPDX-License-Identifier: Apache-2.0
"""The centralized law: a PID controller for each mode of the payload, from all sensors to all voltages.

    q = T^-1 a,    u = -s T (G_d q + G_p H q + G_i H H q),    H(s) = s / (s + w_l)^2

a are the upper accelerations of all struts without bias, q those of the modes (w, alpha, beta; T: see
`satvib_common.struts`), or those of the motions of a payload on listed struts, where T is their Jacobian and T^-1 its
pseudo-inverse, H the drift-free integrator of `satvib_common.signals`, G diagonal, s the polarity of the
wiring. The controlled quantity is the velocity of a mode: P acts like a damper against the sky, I like a spring, D like
a mass.

For struts that are spread evenly T^T T is diagonal. Equal gains for all modes are then the same PID at every strut:
with G_p alone, `velocity_feedback` with a fixed gain.

When one sensor is missing no mode is known, and the law gives 0 V to all struts for that sample.
"""

from enum import IntEnum

import numpy as np
from satvib_common.arrays import Array, Complex, Mask
from satvib_common.errors import SatvibError
from satvib_common.kernels.compile import kernel
from satvib_common.kernels.direct_form import filter_sample
from satvib_common.kernels.ordered_dot import dot_of
from satvib_common.phases import Phase
from satvib_common.signals.integrator import leaky_integrator
from satvib_common.struts.motions import mode_matrix, strut_matrix

from satvib_control.laws.base import BasicLaw, LawInput
from satvib_control.laws.centralized.parameters import CentralizedParameters
from satvib_control.laws.reasons import reason

BLIND = reason('0 V: the upper acceleration of a strut is missing, so no mode is known')


class _Gain(IntEnum):
    """Rows of the gains."""

    P = 0
    I = 1  # noqa: E741 - the name of the gain
    D = 2


@kernel(
    'void(f8[:,:],f8[:,:],f8[:,:],f8[:,:],f8[:,:,:],f8[:],f8[:])',
    '(n,m),(m,n),(g,m),(c,t),(m,w,s),(n)->(n)',
    writable=('state',),
)
def modal_step(strut, mode, gains, integrator, state, y, u):
    """One sample of all struts of one item.

    Args:
        strut: (n, m) T.
        mode: (m, n) T^-1.
        gains: (3, m) rows P, I, D; V/(m/s), V/m, V/(m/s^2).
        integrator: (2, 3) b and a of H.
        state: (m, 2, 2) states of the two integrators of each mode, changed.
        y: (n) m/s^2.
        u: (n) out, V.
    """
    b, a = integrator[0], integrator[1]
    u[:] = 0.0
    for m in range(mode.shape[0]):
        q = dot_of(mode[m], y)
        v = filter_sample(b, a, state[m, 0], q)
        x = filter_sample(b, a, state[m, 1], v)
        wanted = gains[_Gain.P, m] * v + gains[_Gain.I, m] * x + gains[_Gain.D, m] * q
        for i in range(y.shape[0]):
            u[i] -= strut[i, m] * wanted


class Centralized(BasicLaw[CentralizedParameters]):
    """The law on the last axis of `shape`, which counts all struts; see the module.

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
        if p.strut_shapes:
            self._strut = np.array(p.strut_shapes).reshape(p.struts, -1)
            self._mode = np.linalg.pinv(self._strut)
        else:
            angles = p.strut_angles[: p.struts]
            self._strut, self._mode = strut_matrix(angles), mode_matrix(angles)
        self._integrator = np.array(leaky_integrator(p.velocity_corner, dt))
        self._state = np.zeros((*shape[:-1], p.modes, 2, 2))
        self.apply(p)

    def apply(self, parameters: CentralizedParameters) -> None:
        """Take other gains; the integrators go on."""
        super().apply(parameters)
        p, n, shape = parameters, parameters.struts, self.shape
        self._gains = p.velocity_polarity * np.array(p.gains())
        # shown for each strut: the gains from its own sensor to its own voltage
        own = [
            np.array([sum(self._strut[i] * row * self._mode[:, i]) for i in range(n)])
            for row in self._gains
        ]
        self.state.ki = np.broadcast_to(own[_Gain.P], shape)
        self.state.kp = np.broadcast_to(own[_Gain.D], shape)

    def step(self, x: LawInput, phase: Phase) -> Array:  # noqa: ARG002 - the same in every phase
        """Give the voltages (shape, V)."""
        known = np.broadcast_to(np.all(x.valid, axis=-1, keepdims=True), self.shape)
        y = np.where(known, x.upper, 0.0)
        u = modal_step(self._strut, self._mode, self._gains, self._integrator, self._state, y)
        self.state.reason = np.where(known, 0, BLIND)
        return np.where(known, u, 0.0)

    def response_matrix(self, omega: Array) -> Complex:
        """Give C (q, n, n) at frequencies (q,) in rad/sample, u = -C y over all struts."""
        turn = np.exp(-1j * omega)
        b, a = self._integrator
        h = np.polyval(b[::-1], turn) / np.polyval(a[::-1], turn)
        p, i, d = (row[None, :] for row in self._gains)
        modes = p * h[:, None] + i * h[:, None] ** 2 + d
        return np.asarray(np.einsum('im,qm,mj->qij', self._strut, modes, self._mode))

    def reset(self, mask: Mask | bool = True) -> None:
        """Set all integrators of an item to 0 where `mask` holds for any of its struts."""
        any_of = np.any(np.broadcast_to(np.asarray(mask), self.shape), axis=-1)
        self._state[...] = np.where(any_of[..., None, None, None], 0.0, self._state)
