# SPDX-FileCopyrightText: 2026 The satvib authors
# SPDX-License-Identifier: Apache-2.0
"""A fixed linear controller in state space, its matrices as parameters.

    u(k) = s (C x(k) + D y(k)),    x(k+1) = A x(k) + B y(k) + E s v(k)

y are the upper accelerations without bias, v the voltages that were applied, s = +-1 the polarity of the wiring. In
`strut_controller` the law has the reading and the voltage of its strut, in `centralized_controller` those of all struts
at once. Whatever was designed elsewhere runs by it: an observer with state feedback (LQG, H2), a compensator of
H-infinity synthesis, a notch. `satvib tune` makes the first and the last.

E keeps the states right where the voltage is not the one that was asked for: before CONTROL, while it is faded in, at
the guard's limits. An observer needs the applied voltage there, and any other controller is kept from winding up by it.

When one sensor is missing, a controller of all struts gives 0 V to all of them for that sample.
"""

import numpy as np
from satvib_common.arrays import Array, Complex, Mask
from satvib_common.errors import SatvibError
from satvib_common.kernels.compile import kernel
from satvib_common.kernels.ordered_dot import dot_of
from satvib_common.phases import Phase

from satvib_control.laws.base import BasicLaw, LawInput
from satvib_control.laws.centralized.parameters import CentralizedParameters
from satvib_control.laws.reasons import reason
from satvib_control.laws.state_space.matrices import response
from satvib_control.laws.state_space.parameters import StateSpaceParameters

BLIND = reason('0 V: the upper acceleration of a strut is missing, and the law needs all of them')


@kernel(
    'void(f8[:,:],f8[:,:],f8[:,:],f8[:,:],f8[:,:],f8[:],f8[:],f8[:],f8[:])',
    '(p,p),(p,m),(m,p),(m,m),(p,m),(p),(m),(m)->(m)',
    writable=('state',),
)
def state_space_step(a, b, c, d, e, state, y, applied, u):
    """One sample of one item.

    Args:
        a, b, c, d, e: the matrices.
        state: (p) changed; what the applied voltage of the sample before adds to it comes first.
        y: (m) m/s^2.
        applied: (m) V, of the sample before.
        u: (m) out, V.
    """
    for i in range(state.shape[0]):
        state[i] += dot_of(e[i], applied)
    for j in range(u.shape[0]):
        u[j] = dot_of(c[j], state) + dot_of(d[j], y)
    before = state.copy()
    for i in range(state.shape[0]):
        state[i] = dot_of(a[i], before) + dot_of(b[i], y)


class StateSpace(BasicLaw[StateSpaceParameters]):
    """The law of one strut (shape), or of all struts on the last axis of `shape`; see the module.

    Raises:
        SatvibError: parameters of all struts, and a shape without them.
    """

    fixed_filter = True

    def __init__(
        self, parameters: StateSpaceParameters, dt: float, shape: tuple[int, ...] = ()
    ) -> None:
        super().__init__(parameters, dt, shape)
        p = parameters
        self._together = isinstance(p, CentralizedParameters)
        if self._together and shape[-1:] != (p.channels,):
            raise SatvibError(
                f'law: state_space of {p.channels} struts needs all of them at once; set scheme: centralized in the '
                'scenario'
            )
        self._matrices = p.matrices()
        items = shape[:-1] if self._together else shape
        self._state = np.zeros((*items, len(self._matrices.A)))

    def step(self, x: LawInput, phase: Phase) -> Array:  # noqa: ARG002 - the same in every phase
        """Give the voltages (shape, V)."""
        polarity = self.parameters.velocity_polarity
        known, y, applied = x.valid, x.upper, polarity * x.applied
        if self._together:
            known = np.broadcast_to(np.all(known, axis=-1, keepdims=True), self.shape)
            self.state.reason = np.where(known, 0, BLIND)
            y = np.where(known, y, 0.0)
            u = state_space_step(*self._matrices, self._state, y, applied)
        else:
            # upper is 0 where it was not measured
            one = state_space_step(*self._matrices, self._state, y[..., None], applied[..., None])
            u = one[..., 0]
        return np.where(known, polarity * u, 0.0)

    def response(self, omega: Array) -> Complex:
        """C of one strut at frequencies (*shape, q) in rad/sample, u = -C y."""
        return np.asarray(
            -self.parameters.velocity_polarity * response(self._matrices, omega)[..., 0, 0]
        )

    def reset(self, mask: Mask | bool = True) -> None:
        """Set the states of an item to 0 where `mask` (shape) holds, for any of its struts."""
        rest = np.broadcast_to(np.asarray(mask), self.shape)
        if self._together:
            rest = np.any(rest, axis=-1)
        self._state[...] = np.where(rest[..., None], 0.0, self._state)
