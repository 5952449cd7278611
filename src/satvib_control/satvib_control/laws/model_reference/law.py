# SPDX-FileCopyrightText: 2026 The satvib authors
# SPDX-License-Identifier: Apache-2.0
"""Model reference adaptive PID control on the identified model: the paper's Eqs. (34)-(41), made safe.

Law, Eq. (35), with F in the place of 1/s:

    u = K_p (u_c - y) + K_i F(z) (u_c - y) - K_d D(z) y,    D(z) = (1 - z^-1) / T.

F is the drift-free integrator of `satvib_common.signals`, not the D(z) of Eq. (38): that one has its pole at z = 1
and turns the smallest bias of an accelerometer into a voltage that grows until it stands at the limit.

Closed loop, Eq. (40) with the signs of the identified model: with G = B/A, C_r = K_p + K_i F, C_y = C_r + K_d D,

    H = C_r G / (1 + C_y G),    S = 1 / (1 + C_y G).

Sensitivities. Eq. (41) as printed lacks the squared denominator of dH/dK_i. The derivatives are

    dH/dK_p = G S (1 - H),    dH/dK_i = F G S (1 - H),    dH/dK_d = -D G S H,

so with eps = u_c - y_hat and y_hat = H u_c they are G S filtered eps, F eps and -D y_hat. In CONTROL there is no u_c
and the same filters on eps = -y, y_hat = y give dy/dK of the vibration itself, since y = S d.

Adaptation by `adaptation` with e = y - y_m, projected on what the identified model proves stable with the modulus
margin: K_i alone on its interval (`gain_bounds`), several gains along their ray (`gain_projection`).

In ADAPT u_c is an excitation and y_m the output of the reference model: the identified model closed with the K_i that
gives its dominant mode the wanted damping (it starts from the state the plant is in), or the designed

    H_m = (1 - zeta_0 / zeta_m) 2 zeta_m w s / (s^2 + 2 zeta_m w s + w^2),

what an ideal skyhook damper makes of a mode zeta_0, w, sampled and late like the model. In CONTROL u_c = 0, and gains
move only when `adapt_in_control` is set, with y_m = 0: the gradient of the vibration's own power.
"""

import cmath
import math

import numpy as np
from satvib_common.arrays import Array, Mask
from satvib_common.phases import Phase
from satvib_common.signals.integrator import leaky_integrator
from satvib_ident.models.iir_model import IirModel

from satvib_control.laws.base import BasicLaw, LawInput
from satvib_control.laws.model_reference import step as place
from satvib_control.laws.model_reference.adaptation import move
from satvib_control.laws.model_reference.parameters import ModelReferenceParameters
from satvib_control.laws.model_reference.reference_model import designed_model
from satvib_control.laws.model_reference.step import pid_step
from satvib_control.laws.reasons import reason
from satvib_control.laws.strut_excitation import StrutSignals
from satvib_control.model_analysis.dominant_mode import damping_gain, dominant_pole, polarity
from satvib_control.model_analysis.gain_bounds import gain_bounds
from satvib_control.model_analysis.gain_projection import loop_grid, ray
from satvib_control.model_analysis.transfer import model_polynomials, multiply, value

NO_MODEL = reason('no trusted identified model: 0 V')
UNATTAINABLE = reason('the wanted damping is not attainable within the modulus margin')
SATURATED = reason('adaptation frozen: the voltage is saturated')
UNTUNED = reason('the gain is still 0: no ADAPT so far, and adapt_in_control is off')
IDLE = reason('adaptation frozen: not excited')
GAINS = ('kp', 'ki', 'kd')


class ModelReference(BasicLaw[ModelReferenceParameters]):
    """Adaptive PID; see the module's page."""

    needs_model = True

    def __init__(
        self, parameters: ModelReferenceParameters, dt: float, shape: tuple[int, ...] = ()
    ) -> None:
        super().__init__(parameters, dt, shape)
        p = parameters
        self._integrator = tuple(np.array(c) for c in leaky_integrator(p.velocity_corner, dt))
        self._reference = StrutSignals(
            p.reference_excitation, 1.0, p.reference_frequencies, p, shape
        )
        self._begun: int | None = None
        self._known = np.zeros(shape, dtype=bool)
        self._untuned = np.ones(shape, dtype=bool)
        self._attainable = np.ones(shape, dtype=bool)
        self._amplitude = np.zeros(shape)
        # several gains are projected together, which costs a pass over the Nyquist curve
        self._several = bool(set(p.adapted_gains) - {'ki'}) or p.gain_p != 0.0 or p.gain_d != 0.0
        self._grid = np.zeros((*shape, 6, 1))
        self._rule = np.zeros(5)  # of `adaptation.move`
        self._settings = np.zeros((*shape, 5))  # of `pid_step`
        self._scale = np.zeros((*shape, 3))  # size of each gain; 0: it does not adapt
        self._rest = np.zeros((*shape, 3))
        self._low, self._high = np.zeros(shape), np.zeros(shape)
        self._memory = np.zeros((*shape, place.MEMORY))
        self.apply(p)
        self._size(6, 4)
        self.state.reason = np.full(shape, NO_MODEL)
        self._show_gains()

    def apply(self, parameters: ModelReferenceParameters) -> None:
        """Take the settings of the adaptation."""
        super().apply(parameters)
        p, s = parameters, self._settings
        leaks = (p.adaptation_leakage, p.adaptation_error_leakage)
        self._rule = np.array([self.dt, p.adaptation_rate, p.adaptation_dead_zone, *leaks])
        s[..., 0] = self.dt
        s[..., 1] = 1.0 - math.exp(-self.dt / p.adaptation_memory)
        s[..., 2] = float(p.reference_model == 'designed')
        s[..., 4] = 1.0 / (1.0 + 2.0 * math.pi * p.velocity_corner * self.dt)

    def _size(self, length: int, order: int) -> None:
        """Make room for polynomials of that length (loop, and model), at rest and without effect."""
        self._loop = np.zeros((*self.shape, 4, length))
        self._fixed = np.zeros((*self.shape, 6, length))
        self._filters = np.zeros((*self.shape, 6, length - 1))
        self._loop[..., 0, 0] = self._fixed[..., 1, 0] = self._fixed[..., 5, 0] = 1.0
        self._fixed[..., 2, :3], self._fixed[..., 3, :3] = self._integrator
        self._order = order
        self._known = np.zeros(self.shape, dtype=bool)

    def _loop_rows(self, model: IirModel) -> Array:
        """A Fa, B Fa, B Fb, B D Fa (*shape, 4, q)."""
        fb, fa = self._integrator
        b, a = model_polynomials(model)
        rows = [multiply(a, fa), multiply(b, fa), multiply(b, fb)]
        derivative = np.array([1.0, -1.0]) / self.dt
        last = multiply(multiply(b, fa), derivative)
        loop = np.zeros((*self.shape, 4, last.shape[-1]))
        for i, row in enumerate(rows):
            loop[..., i, : row.shape[-1]] = row
        loop[..., 3, :] = last
        return loop

    def set_model(self, model: IirModel, trusted: Mask, covariance: Array | None = None) -> None:
        """Design bounds, reference model and sensitivity filters where the model is trusted."""
        p = self.parameters
        fb, fa = self._integrator
        loop = self._loop_rows(model)
        b, a = model_polynomials(model)
        if loop.shape[-1] != self._loop.shape[-1]:
            self._size(loop.shape[-1], b.shape[-1])
        cov = covariance if p.gain_confidence > 0.0 else None
        bounds = gain_bounds(model, fb, fa, p.modulus_margin, cov, p.gain_confidence)
        sign = polarity(model, fb, fa)
        limit = np.where(sign > 0.0, bounds.maximum, bounds.minimum)
        wanted, damping = damping_gain(model, fb, fa, limit, p.reference_damping)
        low, high = np.minimum(limit, 0.0), np.maximum(limit, 0.0)
        closed = loop[..., 0, :] + wanted[..., None] * loop[..., 2, :]
        amplitude = p.reference_voltage / self._voltage_per_reference(wanted, loop, closed)
        fixed = self._fixed.copy()
        fixed[..., 0, : b.shape[-1]], fixed[..., 1, : a.shape[-1]] = b, a
        if p.reference_model == 'designed':
            frequency = 2.0 * math.pi * p.reference_frequency
            designed = designed_model(
                model, frequency, p.reference_damping, dominant_pole(model, fb, fa)
            )
            fixed[..., 4:6, : designed.shape[-1]] = designed

        start = sign[..., None] * np.array([p.gain_p, p.gain_i, p.gain_d])
        memory, settings = self._memory.copy(), self._settings.copy()
        speed = np.maximum(np.abs(dominant_pole(model, fb, fa)), 1e-3)
        sizes = np.stack([np.abs(limit) / speed, np.abs(limit), np.abs(limit) / speed**2], axis=-1)
        gains = np.where(self._known[..., None], memory[..., :3], start)
        for k in (start, gains):
            k[..., 1] = np.minimum(np.maximum(k[..., 1], low), high)
        if self._several:
            grid = loop_grid([loop[..., 1, :], loop[..., 2, :], loop[..., 3, :]], loop[..., 0, :])
            start, gains = (ray(k, sizes, grid, p.modulus_margin) for k in (start, gains))
            self._grid = np.where(trusted[..., None, None], grid, self._grid)
        memory[..., :3], memory[..., place.WANTED] = gains, wanted
        settings[..., 3] = sign if p.adaptation_rule == 'lyapunov' else 0.0
        adapted = np.array([float(name in p.adapted_gains) for name in GAINS])

        one, two = trusted[..., None], trusted[..., None, None]
        self._loop = np.where(two, loop, self._loop)
        self._fixed = np.where(two, fixed, self._fixed)
        self._settings = np.where(one, settings, self._settings)
        self._memory = np.where(one, memory, self._memory)
        self._rest = np.where(one, start, self._rest)
        self._scale = np.where(one, sizes * adapted, self._scale)
        self._low, self._high = (
            np.where(trusted, low, self._low),
            np.where(trusted, high, self._high),
        )
        self._attainable = np.where(trusted, damping >= p.reference_damping, self._attainable)
        self._amplitude = np.where(trusted, amplitude, self._amplitude)
        self._known = self._known | trusted
        self.state.ki_min = np.where(trusted, low, self.state.ki_min)
        self.state.ki_max = np.where(trusted, high, self.state.ki_max)

    def _voltage_per_reference(self, gain: Array, loop: Array, closed: Array) -> Array:
        """|K F S| at the strongest of the reference's frequencies, V per m/s^2, at least a trifle."""
        fb, fa = self._integrator
        out = np.full(self.shape, 1e-6)
        for i in np.ndindex(self.shape):
            for frequency in self.parameters.reference_frequencies:
                zi = cmath.exp(-2j * math.pi * frequency * self.dt)
                s = value(loop[i][0], zi) / value(closed[i], zi)
                out[i] = max(out[i], abs(float(gain[i]) * value(fb, zi) / value(fa, zi) * s))
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
        u, model_output, error, eta, error_pass, eta_pass = pid_step(
            self._loop, self._fixed, self._settings, self._scale, self._memory, self._filters,
            x.upper, reference, x.applied, float(adapt),
        )  # fmt: skip
        state = self.state
        state.reference, state.model_output, state.error = reference, model_output, error
        first = (
            GAINS.index(self.parameters.adapted_gains[0]) if self.parameters.adapted_gains else 1
        )
        state.sensitivity, state.adapting = eta[..., first], np.zeros(self.shape, dtype=bool)
        fine = np.where(self._attainable, 0, UNATTAINABLE)
        if wanted:
            state.adapting = self._adapt(learn, error_pass, eta_pass)
            self._untuned = self._untuned & ~state.adapting
            fine = np.where(state.adapting, fine, np.where(x.saturated, SATURATED, IDLE))
        elif phase == Phase.CONTROL:
            nothing = self._untuned & (self._memory[..., 1] == 0.0) & (self._memory[..., 0] == 0.0)
            fine = np.where(nothing, UNTUNED, fine)
        state.reason = np.where(self._known, fine, NO_MODEL)
        self._show_gains()
        return np.asarray(u)

    def _adapt(self, learn: Mask, error: Array, eta: Array) -> Mask:
        """Move the gains where `learn` (shape) holds and they are excited; (shape) where any of them moved."""
        p = self.parameters
        gains, power = self._memory[..., :3], self._memory[..., place.POWER : place.POWER + 3]
        normalized = 0.0 if p.adaptation_rule == 'mit' else 1.0
        new = move(gains, self._rest, error[..., None], eta, power, normalized, self._rule)
        if normalized:
            # e eta / n estimates how far the gain is off: not believed beyond the size of the gain
            most = self._rule[0] * self._rule[1] * self._scale
            new = np.minimum(np.maximum(new, gains - most), gains + most)
        effect = np.sqrt(np.maximum(power, eta * eta)) * self._scale
        pick = learn[..., None] & (self._scale > 0.0) & (effect > p.adaptation_floor)
        new = np.where(pick, new, gains)
        new[..., 1] = np.minimum(np.maximum(new[..., 1], self._low), self._high)
        if self._several:
            new = ray(new, self._scale, self._grid, p.modulus_margin)
        any_moved = pick[..., 0] | pick[..., 1] | pick[..., 2]
        self._memory[..., :3] = np.where(any_moved[..., None], new, gains)
        return any_moved

    def _show_gains(self) -> None:
        state = self.state
        state.kp, state.ki, state.kd = (self._memory[..., i].copy() for i in range(3))

    def reset(self, mask: Mask | bool = True) -> None:
        """Gains to their start, filters at rest."""
        pick = np.broadcast_to(np.asarray(mask), self.shape)[..., None]
        memory = np.zeros_like(self._memory)
        memory[..., :3] = self._rest
        memory[..., place.WANTED] = self._memory[..., place.WANTED]
        self._memory = np.where(pick, memory, self._memory)
        self._filters = np.where(pick[..., None], 0.0, self._filters)
