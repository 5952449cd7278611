# SPDX-FileCopyrightText: 2026 The satvib authors
# SPDX-License-Identifier: Apache-2.0
"""Model reference adaptive PID control on the identified model: the paper's Eqs. (34)-(41), made safe.

Law, Eq. (35), with F in the place of 1/s:

    u = K_p (u_c - y) + K_i F(z) (u_c - y) - K_d D(z) y,    D(z) = (1 - z^-1) / T.

F is the drift-free integrator of `satvib_common.integrator`, not the D(z) of Eq. (38): that one has its pole at z = 1
and turns the smallest bias of an accelerometer into a voltage that grows until it stands at the limit.

Closed loop, Eq. (40) with the signs of the identified model: with G = B/A, C_r = K_p + K_i F, C_y = C_r + K_d D,

    H = C_r G / (1 + C_y G),    S = 1 / (1 + C_y G).

Sensitivities. Eq. (41) as printed lacks the squared denominator of dH/dK_i. The derivatives are

    dH/dK_p = G S (1 - H),    dH/dK_i = F G S (1 - H),    dH/dK_d = -D G S H,

so with eps = u_c - y_hat and y_hat = H u_c they are G S filtered eps, F eps and -D y_hat. In CONTROL there is no u_c
and the same filters on eps = -y, y_hat = y give dy/dK of the vibration itself, since y = S d.

Adaptation, the MIT rule dK/dt = -gamma e de/dK, normalized by the power of its own gradient:

    K_j <- K_j - gamma T e eta_j / max(eta_j^2, <eta_j^2>),    e = y - y_m,

and projected on what the identified model proves stable with the modulus margin. y_m is the identified model closed
with the K_i that gives its dominant poles the wanted damping; in CONTROL y_m = 0.
"""

import cmath
import math
from typing import TYPE_CHECKING, Any

import numpy as np
from numba import njit
from satvib_common.integrator import leaky_integrator
from satvib_common.kernel import kernel
from satvib_common.phases import Phase

from satvib_control.dominant import damping_gain, polarity
from satvib_control.gain_bounds import gain_bounds
from satvib_control.law import Array, BasicLaw, LawInput, Mask
from satvib_control.polynomial import model_polynomials, multiply, value
from satvib_control.reasons import reason
from satvib_control.signals import StrutSignals

if TYPE_CHECKING:
    from satvib_ident.iir_model import IirModel

    from satvib_control.parameters import ControllerParameters

NO_MODEL = reason('no trusted identified model: 0 V')
UNATTAINABLE = reason('the wanted damping is not attainable within the modulus margin')
SATURATED = reason('adaptation frozen: the voltage is saturated')
IDLE = reason('adaptation frozen: not excited')


@njit(cache=True)
def _filter(b: Any, a: Any, state: Any, x: Any) -> float:
    """Direct form II transposed; `state` has one place less than b and a; a[0] is 1."""
    order = b.shape[0] - 1
    y = b[0] * x + state[0]
    for i in range(order - 1):
        state[i] = state[i + 1] + b[i + 1] * x - a[i + 1] * y
    state[order - 1] = b[order] * x - a[order] * y
    return y


@kernel(
    'void(f8[:,:],f8[:,:],f8[:],f8[:],f8[:,:],f8,f8,f8,f8,f8,f8[:],f8[:],f8[:],f8[:],f8[:])',
    '(l,q),(r,q),(s),(k),(t,o),(),(),(),(),()->(),(),(),(),()',
    writable=('memory', 'filters'),
)
def _step(
    loop: Any,
    fixed: Any,
    settings: Any,
    memory: Any,
    filters: Any,
    y: Any,
    reference: Any,
    applied: Any,
    adapt: Any,
    learn: Any,
    u: Any,
    ym: Any,
    e: Any,
    eta: Any,
    moved: Any,
) -> None:
    """One sample of one item; `adapt`: 1 in ADAPT, else 0; `learn`: 1 where the gain may move.

    loop: rows A Fa, B Fa and B Fb. fixed: rows B, A, Fb, Fa.
    memory: power of the gradient, K_i, wanted K_i, two states of F each in law, reference model and sensitivity,
    the reference model's voltage, `adapt` of the sample before.
    filters: states of H, of G S and of the reference model's G.
    """
    q = loop.shape[1]
    ki = memory[1]
    den = np.empty(q)
    num = np.empty(q)
    for i in range(q):
        num[i] = ki * loop[2, i]
        den[i] = loop[0, i] + num[i]
    fb, fa = fixed[2, :3], fixed[3, :3]
    dt, gamma, forget, floor, low, high = settings
    # outside ADAPT the reference model follows the applied voltage, so that ADAPT begins where the plant is
    _filter(fixed[0], fixed[1], filters[2], memory[9] if memory[10] == 1.0 else applied)
    ym[0] = filters[2, 0]  # B begins with the delay, so the state holds the next output
    u[0] = ki * _filter(fb, fa, memory[3:5], reference - y)
    driven = _filter(fb, fa, memory[5:7], reference - (ym[0] if adapt == 1.0 else y))
    predicted = _filter(num, den, filters[0], reference)
    memory[9] = memory[2] * driven
    memory[10] = adapt
    if adapt != 1.0:
        ym[0] = 0.0
        predicted = y
    e[0] = y - ym[0]
    integral = _filter(fb, fa, memory[7:9], reference - predicted)
    eta[0] = _filter(loop[1], den, filters[1], integral)
    memory[0] += forget * (eta[0] * eta[0] - memory[0])
    moved[0] = 0.0
    power = max(eta[0] * eta[0], memory[0])
    if learn == 1.0 and power * max(high * high, low * low) > floor * floor:
        memory[1] = min(max(ki - gamma * dt * e[0] * eta[0] / power, low), high)
        moved[0] = 1.0


class ModelReference(BasicLaw):
    """MIT rule on K_i; see the module's page."""

    needs_model = True

    def __init__(
        self, parameters: 'ControllerParameters', dt: float, shape: tuple[int, ...] = ()
    ) -> None:
        super().__init__(parameters, dt, shape)
        p = parameters
        self._integrator = leaky_integrator(p.velocity_corner, dt)
        self._reference = StrutSignals(
            p.reference_excitation, 1.0, p.reference_frequencies, p, shape
        )
        self._begun: int | None = None
        self._known = np.zeros(shape, dtype=bool)
        self._attainable = np.ones(shape, dtype=bool)
        self._amplitude = np.zeros(shape)
        self._settings = np.zeros((*shape, 6))
        self._settings[..., 0] = dt
        self._settings[..., 1] = p.adaptation_rate
        self._settings[..., 2] = 1.0 - np.exp(-dt / p.adaptation_memory)
        self._settings[..., 3] = p.adaptation_floor
        self._memory = np.zeros((*shape, 11))
        self._size(3)
        self.state.ki = np.zeros(shape)
        self.state.reason = np.full(shape, NO_MODEL)

    def _size(self, length: int) -> None:
        """Make room for polynomials of that length, at rest and without effect."""
        self._loop = np.zeros((*self.shape, 3, length))
        self._fixed = np.zeros((*self.shape, 4, length))
        self._filters = np.zeros((*self.shape, 3, length - 1))
        self._loop[..., 0, 0] = 1.0
        self._fixed[..., 1, 0] = 1.0
        self._fixed[..., 2, :3], self._fixed[..., 3, :3] = self._integrator

    def set_model(self, model: 'IirModel', trusted: Mask, covariance: Array | None = None) -> None:
        """Design bounds, reference model and sensitivity filters where the model is trusted."""
        p = self.parameters
        fb, fa = (np.asarray(c) for c in self._integrator)
        b, a = model_polynomials(model)
        base, plain, integral = multiply(a, fa), multiply(b, fa), multiply(b, fb)
        if base.shape[-1] != self._loop.shape[-1]:
            self._size(base.shape[-1])
            self._known = np.zeros(self.shape, dtype=bool)
        bounds = gain_bounds(
            model, fb, fa, p.modulus_margin,
            covariance if p.gain_confidence > 0.0 else None, p.gain_confidence,
        )  # fmt: skip
        sign = polarity(model, fb, fa)
        limit = np.where(sign > 0.0, bounds.maximum, bounds.minimum)
        wanted, damping = damping_gain(model, fb, fa, limit, p.reference_damping)
        pick = trusted[..., None, None]
        loop = np.stack([base, plain, integral], axis=-2)
        closed = base + wanted[..., None] * integral
        self._loop[...] = np.where(pick, loop, self._loop)
        self._fixed[..., 0, : b.shape[-1]] = np.where(
            trusted[..., None], b, self._fixed[..., 0, : b.shape[-1]]
        )
        self._fixed[..., 1, : a.shape[-1]] = np.where(
            trusted[..., None], a, self._fixed[..., 1, : a.shape[-1]]
        )
        self._memory[..., 2] = np.where(trusted, wanted, self._memory[..., 2])
        low, high = np.minimum(limit, 0.0), np.maximum(limit, 0.0)
        bounded = np.stack([low, high], axis=-1)
        self._settings[..., 4:] = np.where(trusted[..., None], bounded, self._settings[..., 4:])
        gain = self._memory[..., 1]
        kept = np.minimum(np.maximum(gain, low), high)
        self._memory[..., 1] = np.where(trusted, kept, gain)
        self._attainable = np.where(trusted, damping >= p.reference_damping, self._attainable)
        amplitude = p.reference_voltage / self._voltage_per_reference(wanted, base, closed)
        self._amplitude = np.where(trusted, amplitude, self._amplitude)
        self._known = self._known | trusted
        self.state.ki_min = np.where(trusted, low, self.state.ki_min)
        self.state.ki_max = np.where(trusted, high, self.state.ki_max)

    def apply(self, parameters: 'ControllerParameters') -> None:
        """Take a new rate of adaptation."""
        super().apply(parameters)
        self._settings[..., 1] = parameters.adaptation_rate

    def _voltage_per_reference(self, gain: Array, base: Array, closed: Array) -> Array:
        """|K F S| at the strongest of the reference's frequencies, V per m/s^2, at least a trifle."""
        out = np.full(self.shape, 1e-6)
        for i in np.ndindex(self.shape):
            for frequency in self.parameters.reference_frequencies:
                zi = cmath.exp(-2j * math.pi * frequency * self.dt)
                c = value(self._integrator[0], zi) / value(self._integrator[1], zi)
                s = value(base[i], zi) / value(closed[i], zi)
                out[i] = max(out[i], abs(float(gain[i]) * c * s))
        return out

    def step(self, x: LawInput, phase: Phase) -> Array:
        """Give the voltage (shape, V)."""
        adapt = phase == Phase.ADAPT
        if adapt:
            self._begun = x.sequence if self._begun is None else self._begun
            reference = self._amplitude * self._reference.at(x.sequence - self._begun)
        else:
            self._begun, reference = None, np.zeros(self.shape)
        wanted = adapt or (phase == Phase.CONTROL and self.parameters.adapt_in_control)
        learn = x.valid & ~x.saturated & self._known & wanted
        u, model_output, error, eta, moved = _step(
            self._loop, self._fixed, self._settings, self._memory, self._filters,
            x.upper, reference, x.applied, float(adapt), learn.astype(float),
        )  # fmt: skip
        state = self.state
        state.reference, state.model_output, state.error = reference, model_output, error
        state.ki, state.sensitivity = self._memory[..., 1].copy(), eta
        state.adapting = moved > 0.0
        frozen = np.where(x.saturated, SATURATED, IDLE)
        why = np.where(
            state.adapting | (not wanted), np.where(self._attainable, 0, UNATTAINABLE), frozen
        )
        state.reason = np.where(self._known, why, NO_MODEL)
        return np.asarray(u)

    def reset(self, mask: Mask | bool = True) -> None:
        """Forget gain and filters."""
        keep = ~np.broadcast_to(np.asarray(mask), self.shape)[..., None]
        self._memory[...] = np.where(keep, self._memory, 0.0)
        self._filters[...] = np.where(keep[..., None], self._filters, 0.0)
