# SPDX-FileCopyrightText: 2026 The satvib authors
# SPDX-License-Identifier: Apache-2.0
"""Model reference adaptive PID control on the identified model: the paper's Eqs. (34)-(41), made safe.

Law, Eq. (35), with F in the place of 1/s:

    u = K_p (u_c - y) + K_i F(z) (u_c - y) - K_d D(z) y,    D(z) = (1 - z^-1) / T.

F is the drift-free integrator of `satvib_common.signals`, not the D(z) of Eq. (38). That one has its pole at z = 1: the
smallest bias of an accelerometer becomes a voltage that grows until it stands at the limit.

Closed loop, Eq. (40) with the signs of the identified model: with G = B/A, C_r = K_p + K_i F, C_y = C_r + K_d D,

    H = C_r G / (1 + C_y G),    S = 1 / (1 + C_y G).

Sensitivities. In Eq. (41) as printed the second term lacks the square of the denominator, and its sign is wrong: with
H = -K_i P / (Q - K_i P), Eq. (40), dH/dK_i = -P / (Q - K_i P) - K_i P^2 / (Q - K_i P)^2. The derivatives are

    dH/dK_p = G S (1 - H),    dH/dK_i = F G S (1 - H),    dH/dK_d = -D G S H,

so with eps = u_c - y_hat and y_hat = H u_c they are G S filtered eps, F eps and -D y_hat. In CONTROL there is no u_c.
The same filters on eps = -y, y_hat = y then give dy/dK of the vibration itself, because y = S d.

Adaptation is by `adaptation` with e = y - y_m. The gains are projected on what the identified model proves stable with
the modulus margin (`design`): K_i alone on its interval, several gains along their ray.

| phase | u_c | y_m | gains |
|---|---|---|---|
| ADAPT | an excitation | output of the reference model | adapt |
| CONTROL | 0 | 0: the gradient of the vibration's own power | adapt when `adapt_in_control` is set |

The reference model is one of two. The first is the identified model closed with the K_i that gives its dominant mode
the wanted damping; it starts from the state that the plant is in. The second is the designed

    H_m = (1 - zeta_0 / zeta_m) 2 zeta_m w s / (s^2 + 2 zeta_m w s + w^2),

what an ideal skyhook damper makes of a mode zeta_0, w, sampled and late like the model (`reference_model`).
"""

import math

import numpy as np
from satvib_common.arrays import Array, Mask
from satvib_common.phases import Phase
from satvib_common.signals.integrator import leaky_integrator
from satvib_ident.models.iir_model import IirModel

from satvib_control.core.trusted_model import lengthen, select
from satvib_control.laws.base import BasicLaw, LawInput
from satvib_control.laws.model_reference.adaptation import Rule, move
from satvib_control.laws.model_reference.design import Design, make_design, several
from satvib_control.laws.model_reference.parameters import ModelReferenceParameters
from satvib_control.laws.model_reference.step import Gain, Memory, Setting, pid_step
from satvib_control.laws.reasons import reason, shown
from satvib_control.laws.strut_excitation import StrutSignals
from satvib_control.model_analysis.gain_projection import ray

NO_MODEL = reason('no trusted identified model: 0 V')
UNATTAINABLE = reason('the wanted damping is not attainable within the modulus margin')
SATURATED = reason('adaptation frozen: the voltage is saturated')
CLIPPED = reason('adaptation frozen: the upper sensor clips')
UNTUNED = reason('the gain is still 0: no ADAPT so far, and adapt_in_control is off')
IDLE = reason('adaptation frozen: not excited')
MOVED = reason('a gain is outside the bounds of the identified model: the gains are moved to them')


class ModelReference(BasicLaw[ModelReferenceParameters]):
    """Adaptive PID; see the module's page."""

    needs_model = True
    settings = ModelReferenceParameters.own()

    def __init__(
        self, parameters: ModelReferenceParameters, dt: float, shape: tuple[int, ...] = ()
    ) -> None:
        super().__init__(parameters, dt, shape)
        p = parameters
        fb, fa = leaky_integrator(p.velocity_corner, dt)
        self._integrator = np.array(fb), np.array(fa)
        self._reference = StrutSignals(
            p.reference_excitation, 1.0, p.reference_frequencies, p, shape
        )
        self._begun: int | None = None
        self._known = np.zeros(shape, dtype=bool)
        self._order = np.zeros(shape, dtype=np.int64)  # of the loop that the gains were adapted on
        self._untuned = np.ones(shape, dtype=bool)
        self._design = Design.without_model(shape, self._integrator)
        self._moved = np.zeros(shape, dtype=bool)  # a gain that does not adapt is not as asked for
        self._several = several(p)
        self._scale = self._design.sizes  # of each gain; 0: it does not adapt
        self._wanted = self._start_of(p)
        self._settings = np.zeros((*shape, len(Setting)))
        names = [gain.name.lower() for gain in Gain]
        self._adapted = np.array([float(name in p.adapted_gains) for name in names])
        self._shown = names.index(p.adapted_gains[0]) if p.adapted_gains else Gain.KI
        length = self._design.loop.shape[-1]
        self._memory = Memory.at_rest(shape, self._design.start, length)
        self.apply(p)
        self.state.reason = np.full(shape, NO_MODEL)
        self._show_gains()

    def apply(self, parameters: ModelReferenceParameters) -> None:
        """Take the settings of the adaptation, and the gains.

        A gain that does not adapt is the new one from the next sample on, within what the model proves. Of one that
        adapts only the start changes, to which leakage and `reset` bring it back. The filters go on, so the voltage
        differs by what the gains differ, times what they are multiplied by.
        """
        super().apply(parameters)
        p, s = parameters, self._settings
        if self._start_of(p) != self._wanted:
            self._wanted = self._start_of(p)
            self._set_gains(p)
        self._rule = Rule(
            dt=self.dt,
            rate=p.adaptation_rate,
            dead_zone=p.adaptation_dead_zone,
            leakage=p.adaptation_leakage,
            error_leakage=p.adaptation_error_leakage,
        )
        s[..., Setting.DT] = self.dt
        s[..., Setting.FORGET] = 1.0 - math.exp(-self.dt / p.adaptation_memory)
        s[..., Setting.DESIGNED] = float(p.reference_model == 'designed')
        s[..., Setting.PASS] = 1.0 / (1.0 + 2.0 * math.pi * p.velocity_corner * self.dt)

    @staticmethod
    def _start_of(p: ModelReferenceParameters) -> tuple[float, float, float]:
        return p.gain_p, p.gain_i, p.gain_d

    def _set_gains(self, p: ModelReferenceParameters) -> None:
        self._several = several(p)
        self._design = self._design.restarted(p)
        gains, start = self._memory.gains, self._design.start
        new = self._design.within(np.where(self._adapted > 0.0, gains, start), p)
        gains[...] = np.where(self._known[..., None], new, gains)
        self._see_moved()
        self._show_gains()

    def _see_moved(self) -> None:
        asked = self._design.sign[..., None] * np.array(self._wanted)
        differs = (self._memory.gains != asked) & (self._adapted == 0.0)
        self._moved = self._known & np.any(differs, axis=-1)

    def effect_of(self, names: frozenset[str], known: bool) -> str:
        """Say where the bounds of the model have moved the gains, and to which values."""
        said = super().effect_of(names, known)
        if said or not names & {'gain_p', 'gain_i', 'gain_d'} or not self._moved.any():
            return said
        used = [f'{gain.name.lower()} {shown(self._memory.gains[..., gain])}' for gain in Gain]
        return f'moved to the bounds of the identified model: {", ".join(used)}'

    def set_model(self, model: IirModel, trusted: Mask, covariance: Array | None = None) -> None:
        """Design bounds, reference model and sensitivity filters where the model is trusted.

        The gains go on, unless they were adapted on a model of another order: then they begin at their start.
        """
        p = self.parameters
        new = make_design(model, p, self.dt, self._integrator, covariance)
        go_on = self._known & (new.loop.shape[-1] == self._order)
        self._order = np.where(trusted, new.loop.shape[-1], self._order)
        gains, filters = self._memory.gains, self._memory.filters
        gains = select(trusted, select(go_on, new.within(gains, p), new.start), gains)
        self._design = self._design.renewed(new, trusted)
        self._scale = self._design.sizes * self._adapted
        filters = select(trusted & ~go_on, 0.0, lengthen(filters, self._design.loop.shape[-1] - 1))
        self._memory = self._memory._replace(gains=gains, filters=filters)
        self._settings[..., Setting.WANTED] = self._design.wanted
        lyapunov = p.adaptation_rule == 'lyapunov'
        self._settings[..., Setting.LYAPUNOV] = self._design.sign if lyapunov else 0.0
        self._known = self._known | trusted
        self._see_moved()
        self.state.ki_min = np.where(trusted, new.low, self.state.ki_min)
        self.state.ki_max = np.where(trusted, new.high, self.state.ki_max)

    def step(self, x: LawInput, phase: Phase) -> Array:
        """Give the voltage (shape, V)."""
        adapt = phase == Phase.ADAPT
        reference = self._reference_at(x.sequence, adapt)
        design = self._design
        u, model_output, error, eta, error_pass, eta_pass = pid_step(
            design.loop, design.fixed, self._settings, self._scale, *self._memory,
            x.upper, reference, x.applied, float(adapt),
        )  # fmt: skip
        state = self.state
        state.reference, state.model_output, state.error = reference, model_output, error
        state.sensitivity, state.adapting = eta[..., self._shown], np.zeros(self.shape, dtype=bool)
        why = np.where(self._moved, MOVED, np.where(design.attainable, 0, UNATTAINABLE))
        if adapt or (phase == Phase.CONTROL and self.parameters.adapt_in_control):
            learn = x.valid & ~x.upper_clipped & ~x.saturated & self._known
            state.adapting = self._adapt(learn, error_pass, eta_pass)
            self._untuned = self._untuned & ~state.adapting
            frozen = np.where(x.saturated, SATURATED, np.where(x.upper_clipped, CLIPPED, IDLE))
            why = np.where(state.adapting, why, frozen)
        elif phase == Phase.CONTROL:
            kp, ki = self._memory.gains[..., Gain.KP], self._memory.gains[..., Gain.KI]
            untuned = self._untuned & (ki == 0.0) & (kp == 0.0) & ~self._moved
            why = np.where(untuned, UNTUNED, why)
        state.reason = np.where(self._known, why, NO_MODEL)
        self._show_gains()
        return np.asarray(u)

    def _reference_at(self, sequence: int, adapt: bool) -> Array:
        """u_c (shape, m/s^2): an excitation that begins with ADAPT; 0 in other phases."""
        if not adapt:
            self._begun = None
            return np.zeros(self.shape)
        self._begun = sequence if self._begun is None else self._begun
        return self._design.amplitude * self._reference.at(sequence - self._begun)

    def _adapt(self, learn: Mask, error: Array, eta: Array) -> Mask:
        """Move the gains where `learn` (shape) holds and they are excited; (shape) where any of them moved."""
        p, design, rule, scale = self.parameters, self._design, self._rule, self._scale
        gains, power = self._memory.gains, self._memory.power
        normalized = 0.0 if p.adaptation_rule == 'mit' else 1.0
        new = move(gains, design.start, error[..., None], eta, power, normalized, rule)
        if normalized:
            # e eta / n estimates how far the gain is off: not trusted beyond the size of the gain
            most = rule.dt * rule.rate * scale
            new = np.minimum(np.maximum(new, gains - most), gains + most)
        effect = np.sqrt(np.maximum(power, eta * eta)) * scale
        pick = learn[..., None] & (scale > 0.0) & (effect > p.adaptation_floor)
        new = np.where(pick, new, gains)
        new[..., Gain.KI] = np.minimum(np.maximum(new[..., Gain.KI], design.low), design.high)
        if self._several:
            new = ray(new, scale, design.grid, p.modulus_margin)
        any_moved = pick[..., 0] | pick[..., 1] | pick[..., 2]
        gains[...] = select(any_moved, new, gains)
        return any_moved

    def _show_gains(self) -> None:
        state, gains = self.state, self._memory.gains
        state.kp, state.ki, state.kd = (gains[..., gain].copy() for gain in Gain)

    def reset(self, mask: Mask | bool = True) -> None:
        """Gains to their start, filters at rest."""
        pick = np.broadcast_to(np.asarray(mask), self.shape)
        start = Memory.at_rest(self.shape, self._design.start, self._design.loop.shape[-1])
        for kept, new in zip(self._memory, start, strict=True):
            kept[...] = select(pick, new, kept)
