# SPDX-FileCopyrightText: 2026 The satvib authors
# SPDX-License-Identifier: Apache-2.0
"""Feedforward from the lower accelerometer: what comes in is cancelled before it reaches the payload.

"The bottom accelerometer measures the incoming vibration for feedforward control": the paper says no more. Its
references 11-13 use filtered-x. For each sample k:

    x     = x_m - F_hat u                     reference without the strut's own reaction  (reaction)
    phi   = taps of x, its integrals, past u  regressor; phi_f = G_hat phi                (regressor)
    d_hat = y - G_hat u_applied               what the payload would do without the voltage
    e     = d_hat + w^T phi_f                 what the present weights would leave
    w     <- by fxlms, fxrls or filtered_u    G_hat: the identified model
    u     = w^T phi

d_hat and e contain the voltage that the guard let out, so saturation, fading and the other laws of a sum do not change
the gradient. While the voltage is saturated nothing is learnt and the weights shrink, until the coil can give what the
law asks for. The voltage is 0 without a trusted model, without the lower sensor, until its history is complete, and in
most states of `backoff`. The reason in the state says which.
"""

import math
from typing import TYPE_CHECKING

import numpy as np
from satvib_common.arrays import Array, Integers, Mask
from satvib_common.kernels.ordered_dot import dot
from satvib_common.phases import Phase

from satvib_control.laws.base import BasicLaw, LawInput
from satvib_control.laws.feedforward.backoff import Backoff, BackoffState
from satvib_control.laws.feedforward.filtered_u import stabilize
from satvib_control.laws.feedforward.fxlms import fxlms
from satvib_control.laws.feedforward.fxrls import LeastSquares
from satvib_control.laws.feedforward.parameters import FeedforwardParameters
from satvib_control.laws.feedforward.reaction import ReferenceProtection, loop_gain
from satvib_control.laws.feedforward.regressor import FilteredReference
from satvib_control.laws.feedforward.regressor_kernel import Contents
from satvib_control.laws.feedforward.spikes import SpikeLimit
from satvib_control.laws.reasons import last_of, reason

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
CLIPPED = reason('feedforward: adaptation frozen: a sensor clips at its range')

POLE_RADIUS = 0.99  # that the poles of filtered_u stay inside
CUT = 1e-6  # V; less is rounding
LOOP_GAIN = 1.0  # largest |(n - 1) W F_hat| of n struts on one plate: small gain
BOOST = 1.05  # factor by which the leak rises per sample above it
RAIL_TIME = 0.05  # s, time constant with which the weights shrink while saturated
ACTING = (Phase.ADAPT, Phase.CONTROL)


class Feedforward(BasicLaw[FeedforwardParameters]):
    """u = w^T phi; see the module's page.

    Attributes:
        weights: (*shape, p) V/(m/s^2) in the order of the regressor.
        protection: what is known of the reaction.
    """

    needs_model = True
    closes_loop = False
    cancels = True

    def __init__(
        self, parameters: FeedforwardParameters, dt: float, shape: tuple[int, ...] = ()
    ) -> None:
        super().__init__(parameters, dt, shape)
        self._no_reason = np.zeros(shape, dtype=np.int64)
        p = parameters
        self.protection = ReferenceProtection(round(p.feedforward_protection_time / dt), shape)
        poles = p.feedforward_poles if p.feedforward_method == 'filtered_u' else 0
        contents = Contents(p.feedforward_taps, int(p.feedforward_motion), poles)
        self.reference = FilteredReference(
            contents, p.feedforward_motion_corner, self.protection.taps, dt, shape
        )
        self.weights = np.zeros((*shape, contents.size))
        self._power = np.zeros((*shape, 1))  # of fxlms
        size = 0 if p.feedforward_method == 'fxlms' else contents.size
        self._least_squares = LeastSquares(size, shape)
        self._spikes = SpikeLimit(p.feedforward_taps, dt, shape)
        self.backoff = Backoff(shape)
        self._boost = np.ones(shape)
        self._clipped = np.zeros(shape)  # samples until the regressor has no clipped one
        self._demand = np.zeros(shape)
        self._phase, self._sequence = Phase.STANDBY, -1
        self.state.reason = np.full(shape, NO_MODEL)
        self.apply(p)

    def apply(self, parameters: FeedforwardParameters) -> None:
        """Take new settings; those that shape the filter are read-only."""
        super().apply(parameters)
        p = parameters
        self._share = -math.expm1(-self.dt / p.feedforward_memory)
        window = max(round(p.watch_time / self.dt), 1)
        self._spikes.floor = p.feedforward_floor
        self.backoff.tune(window, p.watch_ratio, p.feedforward_floor)

    def set_model(self, model: 'IirModel', trusted: Mask, covariance: Array | None = None) -> None:  # noqa: ARG002
        """Take the secondary path where it is trusted; the voltage does not jump."""
        fresh = self.reference.set_model(model, trusted, self.protection.reaction, self.weights)
        if fresh is not None:
            self.backoff.forgive(fresh)

    def step(self, x: LawInput, phase: Phase) -> Array:
        """Give the voltage (shape, V)."""
        acting, acted = phase in ACTING, self._phase in ACTING
        lost = max(x.sequence - self._sequence - 1, 0) if self._sequence >= 0 else 0
        self._sequence = x.sequence
        lower = self.reference.measured(x.lower, lost)
        alone = Phase.IDENTIFY not in {phase, self._phase}
        usual = self._spikes.reference(lower, ~self.reference.missing & alone)
        if Phase.IDENTIFY in {phase, self._phase}:
            self.protection.learn(lower, x.applied, ~self.reference.missing)
            if phase != Phase.IDENTIFY:
                self.protection.finish()
                self.reference.set_reaction(self.protection.reaction, self.weights)
        own = x.applied if acted else np.zeros(self.shape)
        reference, effect = self.reference.step(
            usual, x.applied, own, self.protection.reaction, self.weights
        )
        able = ~self.reference.missing & (self.reference.filling <= 0.0)
        unclipped = self._unclipped(x)
        # cut by the limit, and not only because another law has its share
        cut = x.saturated & acted & (np.abs(x.applied - self._demand * x.fade) > CUT)
        effect_of_law = np.where(acted, effect, 0.0)
        predicted = x.upper - effect
        error = predicted + dot(self.weights, self.reference.state.filtered)
        whole = x.valid & unclipped & able & alone
        shaken, shock = self._spikes.judge(error, predicted, whole)
        backoff, loud = self.backoff.step(
            x.upper, reference, effect_of_law, cut, whole & ~shock, acting
        )
        self._phase = phase
        able = able & self.reference.known
        learns = (backoff == BackoffState.ACT) | (backoff == BackoffState.LISTEN)
        active = able & learns & loud & whole & ~x.saturated & acting & ~shaken
        self._adapt(error, active)
        self._bound(cut, backoff)
        wanted = self.backoff.share * dot(self.weights, self.reference.state.regressor)
        self._demand = np.where(able & acting, wanted, 0.0)
        state = self.state
        state.reference, state.model_output, state.error = reference, predicted, x.upper
        state.adapting = active
        state.reason = self._why(backoff, loud, x.saturated & acted, ~whole)
        return self._demand

    def _unclipped(self, x: LawInput) -> Mask:
        """Where (shape) neither the upper sample nor one of those in the regressor is clipped."""
        taps = float(self.parameters.feedforward_taps)
        left = np.where(x.lower_clipped, taps, np.maximum(self._clipped - 1.0, 0.0))
        self._clipped = left
        return np.asarray((left == 0.0) & ~x.upper_clipped)

    def _why(self, backoff: Integers, loud: Mask, saturated: Mask, clipped: Mask) -> Integers:
        """Code of the reason; of several the last in this order."""
        listening = (backoff == BackoffState.LISTEN) | (backoff == BackoffState.RING_DOWN)
        backing = (backoff == BackoffState.FADE) | (backoff == BackoffState.RESTART)
        return last_of(
            self._no_reason, (saturated, SATURATED), (~loud, SMALL), (clipped, CLIPPED),
            (listening, LISTENING), (backing, BACKED_OFF),
            (self.reference.filling > 0.0, FILLING), (self.reference.missing, MISSING),
            (backoff == BackoffState.GIVEN_UP, GAVE_UP), (~self.reference.known, NO_MODEL),
        )  # fmt: skip

    def _adapt(self, error: Array, active: Mask) -> None:
        """Move the weights."""
        p, pace, signals = self.parameters, self.backoff.pace, self.reference.state
        leak = np.minimum(p.feedforward_leak * self._boost, 1.0)
        if p.feedforward_method == 'fxlms':
            fxlms(
                signals.filtered, error, active, pace * p.feedforward_step, leak, self._share,
                self.weights, self._power,
            )  # fmt: skip
            return
        # the leak is a share of the power of the reference; that of past voltages depends on the weights
        poles = self.reference.contents.poles
        through = signals.filtered[..., : self.weights.shape[-1] - poles]
        self._least_squares.step(
            self.weights, signals.gradient, error, dot(through, through), active,
            pace=pace, leak=leak, share=self._share,
        )  # fmt: skip
        if poles:
            stabilize(self.weights, poles, POLE_RADIUS)

    def _bound(self, cut: Mask, backoff: Integers) -> None:
        """Keep the weights within what the coil, the user and the other struts' reactions allow."""
        limit = self.parameters.feedforward_weight_limit
        norm = np.sqrt(dot(self.weights, self.weights))
        scale = np.where(norm > limit, limit / np.maximum(norm, 1e-300), 1.0)
        scale = np.where(cut, scale * (1.0 - min(self.dt / RAIL_TIME, 1.0)), scale)
        gone = (backoff == BackoffState.RESTART) | (backoff == BackoffState.GIVEN_UP)
        scale = np.where(gone, 0.0, scale)
        self._forget_power(gone)
        others = self.parameters.feedforward_struts - 1
        if others and self.protection.taps:
            gain = others * loop_gain(
                self.weights, self.reference.table, self.reference.contents.poles,
                self.protection.magnitude,
            )  # fmt: skip
            boost = np.where(gain > LOOP_GAIN, self._boost * BOOST, self._boost / BOOST)
            most = 1.0 / self.parameters.feedforward_leak
            self._boost = np.minimum(np.maximum(boost, 1.0), most)
            # the leak is slow; above twice the bound the weights are scaled at once
            hard = 2.0 * LOOP_GAIN / np.maximum(gain, 2.0 * LOOP_GAIN)
            scale = scale * hard
        self.weights *= scale[..., None]
        self.state.weight_norm = norm * scale

    def reset(self, mask: Mask | bool = True) -> None:
        """Forget weights and filters; the identified model and the learnt reaction stay."""
        pick = np.broadcast_to(np.asarray(mask), self.shape)
        self.reference.reset(pick)
        self.backoff.reset(pick)
        self._forget_power(pick)
        self.weights[...] = np.where(pick[..., None], 0.0, self.weights)
        self._boost = np.where(pick, 1.0, self._boost)
        self._demand = np.where(pick, 0.0, self._demand)

    def _forget_power(self, mask: Mask) -> None:
        """Let the adaptation begin again with the next sample where `mask` holds."""
        self._power[...] = np.where(mask[..., None], 0.0, self._power)
        self._least_squares.reset(mask)
