# SPDX-FileCopyrightText: 2026 The satvib authors
# SPDX-License-Identifier: Apache-2.0
"""Feedforward from the lower accelerometer: what comes in is cancelled before it has passed.

"The bottom accelerometer measures the incoming vibration for feedforward control" is all that the paper says; its
references 11-13 are the filtered-x school. Per sample k, each part in a file of its own:

    x     = x_m - F_hat u                     reference without the strut's own reaction  (reference_protection)
    phi   = taps of x, its integrals, past u  regressor; phi_f = G_hat phi                (reference_line)
    d_hat = y - G_hat u_applied               what the payload would do without the voltage
    e     = d_hat + w^T phi_f                 what the present weights would leave
    w     <- by fxlms, fxrls or filtered_u    G_hat: the identified model
    u     = w^T phi

d_hat and e are formed with the voltage that the guard really let out: saturation, fading in and the other laws of a sum
do not disturb the gradient. While saturated nothing is learnt and the weights shrink, so that the demand comes down to
what the coil can do. The voltage is 0, and the state says why, without a trusted model, without the lower sensor, until
its history is complete again, while the law listens (error_watch), and after it has given up.
"""

import math
from typing import TYPE_CHECKING

import numpy as np
from satvib_common.arrays import Array, Integers, Mask
from satvib_common.kernels.dot import dot
from satvib_common.phases import Phase

from satvib_control.laws.base import BasicLaw, LawInput
from satvib_control.laws.feedforward import backoff as watching
from satvib_control.laws.feedforward.backoff import watch
from satvib_control.laws.feedforward.filtered_u import stabilize
from satvib_control.laws.feedforward.fxlms import fxlms
from satvib_control.laws.feedforward.fxrls import fxrls
from satvib_control.laws.feedforward.parameters import FeedforwardParameters
from satvib_control.laws.feedforward.reaction import ReferenceProtection, loop_gain
from satvib_control.laws.feedforward.regressor import FilteredReference
from satvib_control.laws.reasons import reason

if TYPE_CHECKING:
    from satvib_ident.models.iir_model import IirModel

NO_MODEL = reason('no trusted identified model: 0 V')
MISSING = reason('feedforward: the lower acceleration is missing: 0 V')
FILLING = reason('feedforward: the history of the lower acceleration is not complete: 0 V')
LISTENING = reason('feedforward: listening to the vibration without control: 0 V')
BACKED_OFF = reason('feedforward: backed off, the error had grown')
GAVE_UP = reason('feedforward: given up, the error grew again and again: 0 V')
SMALL = reason('feedforward: adaptation frozen: the reference is too small')
SATURATED = reason('adaptation frozen: the voltage is saturated')

POLE_RADIUS = 0.99
CUT = 1e-6  # V; less is rounding
LOOP_GAIN = 1.0  # |(n - 1) W F_hat| of n struts on one plate; small gain
BOOST = 1.05  # by which the leak rises per sample above it
RAIL_TIME = 0.05  # s, time constant with which the weights shrink while saturated
ACTING = (Phase.ADAPT, Phase.CONTROL)


class Feedforward(BasicLaw[FeedforwardParameters]):
    """u = w^T phi; see the module's page.

    Attributes:
        weights: (*shape, p) V/(m/s^2) in the order of the regressor.
        protection: what is known of the reaction.
    """

    needs_model = True
    cancels = True
    closes_loop = False

    def __init__(
        self, parameters: FeedforwardParameters, dt: float, shape: tuple[int, ...] = ()
    ) -> None:
        super().__init__(parameters, dt, shape)
        p = parameters
        poles = p.feedforward_poles if p.feedforward_method == 'filtered_u' else 0
        self.protection = ReferenceProtection(round(p.feedforward_protection_time / dt), shape)
        self.line = FilteredReference(
            p.feedforward_taps, p.feedforward_motion, p.feedforward_motion_corner, poles,
            self.protection.taps, dt, shape,
        )  # fmt: skip
        size = self.line.size
        self.weights = np.zeros((*shape, size))
        self._power = np.zeros((*shape, 2))
        rows = 0 if p.feedforward_method == 'fxlms' else size
        self._U = np.zeros((*shape, rows, rows))
        self._d = np.zeros((*shape, rows))
        self._watch = np.zeros((*shape, watching.SIZE))
        self._watch[..., watching.PACE] = 1.0
        self._boost = np.ones(shape)
        self._demand = np.zeros(shape)
        self._phase, self._sequence = Phase.STANDBY, -1
        self.state.reason = np.full(shape, NO_MODEL)
        self._tune()

    def _tune(self) -> None:
        """Take what may be changed while running."""
        p, dt = self.parameters, self.dt
        self._settings = np.zeros((*self.shape, 4))
        self._settings[..., 2] = -math.expm1(-dt / p.feedforward_memory)
        window = max(round(p.watch_time / dt), 1)
        self._watch_settings = np.array([window, p.watch_ratio, p.feedforward_floor])

    def apply(self, parameters: FeedforwardParameters) -> None:
        """Take new settings; those that shape the filter are read-only."""
        super().apply(parameters)
        self._tune()

    def set_model(self, model: 'IirModel', trusted: Mask, covariance: Array | None = None) -> None:  # noqa: ARG002
        """Take the secondary path where it is trusted; the voltage does not jump."""
        fresh = self.line.set_model(model, trusted, self.protection.reaction, self.weights)
        if fresh is not None:  # another model is another chance
            again = fresh & (self._watch[..., watching.COUNT] > 0.0)
            self._watch[...] = np.where(again[..., None], 0.0, self._watch)
            pace = self._watch[..., watching.PACE]
            self._watch[..., watching.PACE] = np.where(again, 1.0, pace)

    def step(self, x: LawInput, phase: Phase) -> Array:
        """Give the voltage (shape, V)."""
        acting, acted = phase in ACTING, self._phase in ACTING
        lost = max(x.sequence - self._sequence - 1, 0) if self._sequence >= 0 else 0
        self._sequence = x.sequence
        lower = self.line.measured(x.lower, lost)
        if Phase.IDENTIFY in {phase, self._phase}:
            self.protection.learn(lower, x.applied, ~self.line.missing)
            if phase != Phase.IDENTIFY:
                self.protection.finish()
                self.line.set_reaction(self.protection.reaction, self.weights)
        own = x.applied if acted else np.zeros(self.shape)
        reference, effect = self.line.step(
            lower, x.applied, own, self.protection.reaction, self.weights
        )
        able = ~self.line.missing & (self.line.filling <= 0.0)
        alone = Phase.IDENTIFY not in {phase, self._phase}
        # cut by the limit, and not only held back by somebody else
        cut = x.saturated & acted & (np.abs(x.applied - self._demand * x.fade) > CUT)
        verdict, loud = watch(
            x.upper, reference, np.where(acted, effect, 0.0), cut, x.valid & able & alone,
            acting, self._watch_settings, self._watch,
        )  # fmt: skip
        self._phase = phase
        able = able & self.line.known
        learns = (verdict == watching.LEARN) | (verdict == watching.LISTEN)
        active = able & learns & loud & x.valid & ~x.saturated & acting
        predicted = x.upper - effect
        error = predicted + dot(self.weights, self.line.filtered)
        self._adapt(error, active)
        self._bound(cut, verdict)
        wanted = self._watch[..., watching.SHARE] * dot(self.weights, self.line.regressor)
        self._demand = np.where(able & acting, wanted, 0.0)
        state = self.state
        state.reference, state.model_output, state.error = reference, predicted, x.upper
        state.adapting = active
        state.reason = self._why(verdict, loud, x.saturated & acted)
        return self._demand

    def _why(self, verdict: Array, loud: Mask, saturated: Mask) -> Integers:
        """Code of the reason, the gravest last."""
        why: Integers = np.where(loud, np.where(saturated, SATURATED, 0), SMALL)
        backing = (verdict == watching.FADE) | (verdict == watching.RESTART)
        for case, code in (
            (verdict == watching.LISTEN, LISTENING), (backing, BACKED_OFF),
            (self.line.filling > 0.0, FILLING), (self.line.missing, MISSING),
            (verdict == watching.GIVEN_UP, GAVE_UP), (~self.line.known, NO_MODEL),
        ):  # fmt: skip
            why = np.where(case, code, why)
        return why

    def _adapt(self, error: Array, active: Mask) -> None:
        """Move the weights."""
        p, settings, through = self.parameters, self._settings, self.line.filtered
        pace = self._watch[..., watching.PACE]
        settings[..., 1] = np.minimum(p.feedforward_leak * self._boost, 1.0)
        if p.feedforward_method == 'fxlms':
            settings[..., 0] = pace * p.feedforward_step
            fxlms(through, error, active, settings, self.weights, self._power[..., :1])
            return
        settings[..., 0] = pace
        # the leak is a share of the reference's power; that of past voltages depends on the weights
        through = through[..., : self.line.size - self.line.poles]
        fxrls(
            self.line.gradient, error, dot(through, through), active, settings,
            self.weights, self._U, self._d, self._power,
        )  # fmt: skip
        if self.line.poles:
            stabilize(self.weights, self.line.poles, POLE_RADIUS)

    def _bound(self, cut: Mask, verdict: Array) -> None:
        """Keep the weights within what the coil, the user and the other struts' reactions allow."""
        limit = self.parameters.feedforward_weight_limit
        norm = np.sqrt(dot(self.weights, self.weights))
        scale = np.where(norm > limit, limit / np.maximum(norm, 1e-300), 1.0)
        scale = np.where(cut, scale * (1.0 - min(self.dt / RAIL_TIME, 1.0)), scale)
        gone = (verdict == watching.RESTART) | (verdict == watching.GIVEN_UP)
        scale = np.where(gone, 0.0, scale)
        self._power[...] = np.where(gone[..., None], 0.0, self._power)
        others = self.parameters.feedforward_struts - 1
        if others and self.protection.taps:
            gain = others * loop_gain(
                self.weights, self.line.table, self.line.poles, self.protection.magnitude
            )
            boost = np.where(gain > LOOP_GAIN, self._boost * BOOST, self._boost / BOOST)
            most = 1.0 / self.parameters.feedforward_leak
            self._boost = np.minimum(np.maximum(boost, 1.0), most)
            # the leak takes its time; twice the bound is not waited for
            hard = 2.0 * LOOP_GAIN / np.maximum(gain, 2.0 * LOOP_GAIN)
            scale = scale * hard
        self.weights *= scale[..., None]
        self.state.weight_norm = norm * scale

    def reset(self, mask: Mask | bool = True) -> None:
        """Forget weights and filters; the identified model and the learnt reaction stay."""
        pick = np.broadcast_to(np.asarray(mask), self.shape)
        self.line.reset(pick)
        for array in (self.weights, self._power, self._watch):
            array[...] = np.where(pick[..., None], 0.0, array)
        pace = self._watch[..., watching.PACE]
        self._watch[..., watching.PACE] = np.where(pick, 1.0, pace)
        self._boost = np.where(pick, 1.0, self._boost)
        self._demand = np.where(pick, 0.0, self._demand)
